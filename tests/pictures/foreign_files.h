// Small OpenEXR files as other programs write them, and a fixture that reads them.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "pictures/foreign/foreign_picture.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// The size of all images of `write_parts`, px.
inline constexpr int width = 6, height = 4;
/// The folder of stored OpenEXR files, with a slash at its end.
inline const std::string data_folder = std::string(POSTLENS_TEST_DATA) + "/exr/";

/// The values of a channel, one per pixel.
using Plane = std::vector<float>;

/// A part of an OpenEXR file. `more` changes its header before it is written.
struct Part {
    std::map<std::string, Plane> channels;
    std::string name, view;
    std::function<void(Imf::Header&)> more = [](Imf::Header&) {};
};

/// A plane of one value.
inline Plane even(float v) {
    return Plane(static_cast<std::size_t>(width * height), v);
}

/// Writes parts of scanlines, each with its channels as floats.
inline void write_parts(const std::string& path, const std::vector<Part>& parts) {
    std::vector<Imf::Header> headers;
    for (const Part& p : parts) {
        Imf::Header h(width, height);
        h.setType(Imf::SCANLINEIMAGE);
        if (!p.name.empty()) h.setName(p.name);
        if (!p.view.empty()) h.setView(p.view);
        for (const auto& [name, plane] : p.channels) h.channels().insert(name, Imf::Channel(Imf::FLOAT));
        p.more(h);
        headers.push_back(h);
    }
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::FrameBuffer frame;
        for (const auto& [name, plane] : parts[i].channels) {
            frame.insert(name,
                         Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(plane.data())),
                                    sizeof(float), sizeof(float) * width));
        }
        Imf::OutputPart out(file, static_cast<int>(i));
        out.setFrameBuffer(frame);
        out.writePixels(height);
    }
}

/// The names of the channels of a deep pixel, in the order of its values.
using DeepNames = std::array<const char*, 6>;

/// Writes a deep image of one pixel. A sample has one value per channel. `whole`: name of the channel that is
/// written as integers.
inline void write_deep_pixel(const std::string& path, const std::vector<std::array<float, 6>>& samples,
                             const DeepNames& names = {"R", "G", "B", "A", "Z", "ZBack"},
                             const std::string& whole = "") {
    Imf::Header h(1, 1);
    h.setType(Imf::DEEPSCANLINE);
    h.compression() = Imf::ZIPS_COMPRESSION;
    const auto type = [&](const char* n) { return n == whole ? Imf::UINT : Imf::FLOAT; };
    for (const char* n : names) h.channels().insert(n, Imf::Channel(type(n)));
    Imf::DeepScanLineOutputFile out(path.c_str(), h);
    unsigned count = static_cast<unsigned>(samples.size());
    std::array<Plane, 6> values;
    std::array<float*, 6> pointers{};
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&count), sizeof(unsigned), sizeof(unsigned)));
    for (std::size_t c = 0; c < 6; ++c) {
        for (const auto& s : samples) {
            values[c].push_back(names[c] == whole ? std::bit_cast<float>(static_cast<std::uint32_t>(s[c]))
                                                  : s[c]);
        }
        pointers[c] = values[c].data();
        frame.insert(names[c], Imf::DeepSlice(type(names[c]), reinterpret_cast<char*>(&pointers[c]),
                                              sizeof(float*), sizeof(float*), sizeof(float)));
    }
    out.setFrameBuffer(frame);
    out.writePixels(1);
}

/// Writes OpenEXR files to a folder of its own and reads them as images of other programs.
class ForeignPictureTest : public testing::Test {
  protected:
    ForeignPicture read_deep(const std::vector<std::array<float, 6>>& samples) {
        write_deep_pixel(in("deep.exr"), samples);
        return read_foreign_picture(in("deep.exr"), {}, {});
    }
    std::string in(const std::string& name) { return (folder_.path() / name).string(); }
    ForeignPicture read(const std::vector<Part>& parts, const ForeignChoice& choice = {},
                        const ForeignCameraChoice& camera = {}) {
        write_parts(in("a.exr"), parts);
        return read_foreign_picture(in("a.exr"), choice, camera);
    }
    // The one-line message of the error that `call` must throw, with exit code 3.
    static std::string refusal(const std::function<void()>& call) {
        try {
            call();
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        ADD_FAILURE() << "nothing was refused";
        return "";
    }
    TemporaryFolder folder_;
};

/// Channels of uniform colour (r, 0.5, 0.25) and depth z.
inline std::map<std::string, Plane> rgbz(float r, float z, const std::string& layer = "") {
    return {{layer + "R", even(r)},
            {layer + "G", even(0.5F)},
            {layer + "B", even(0.25F)},
            {layer + "Z", even(z)}};
}

/// Whether the repairs that were made include one of this code.
inline bool warns(const ForeignPicture& p, const std::string& code) {
    return std::any_of(p.repairs.begin(), p.repairs.end(),
                       [&](const ForeignRepair& r) { return r.code == code; });
}

}  // namespace postlens::test
