#include "tracer/render_state.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <bit>
#include <cstring>
#include <exception>
#include <memory>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/error.h"
#include "core/output_file.h"
#include "records/exposure.h"
#include "records/exr_attributes.h"
#include "records/flat_exr.h"

namespace postlens {
namespace {

constexpr const char* settings_attribute = "postlens:render";
constexpr const char* checksum_attribute = "postlens:checksum";

// Number of 32-bit words, one per channel: three floats of colour, then for each half a sample count and
// three doubles of two words each.
std::size_t words_per_pixel(int halves) {
    return 3 + 7 * static_cast<std::size_t>(halves);
}

/// The channels of the file. Each refers to its first word in `words`, which may be null.
std::vector<FlatExr::Channel> channels(int halves, const std::uint32_t* words) {
    std::vector<FlatExr::Channel> out;
    const auto add = [&](std::string name, ExrChannel::Type type) {
        out.push_back({std::move(name), type, words == nullptr ? nullptr : words + out.size()});
    };
    for (const char* colour : {"R", "G", "B"}) add(colour, ExrChannel::Type::float32);
    for (int h = 0; h < halves; ++h) {
        const std::string half = fmt::format("half{}.", h);
        add(half + "samples", ExrChannel::Type::uint32);
        for (const char* colour : {"R", "G", "B"}) {
            add(half + colour + ".low", ExrChannel::Type::uint32);
            add(half + colour + ".high", ExrChannel::Type::uint32);
        }
    }
    return out;
}

std::string text_of(const Imf::Header& header, const char* name) {
    const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
    return attribute == nullptr ? std::string() : attribute->value();
}

std::vector<std::uint32_t> pack(const RenderState& s) {
    Image picture = s.picture();
    set_exposure(picture, 0);
    const std::size_t pixels = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
    std::vector<std::uint32_t> out;
    out.reserve(pixels * words_per_pixel(s.halves));
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            out.push_back(std::bit_cast<std::uint32_t>(picture.rgb[3 * i + c]));
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            out.push_back(s.samples[h][i]);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto bits = std::bit_cast<std::uint64_t>(s.sums[h][3 * i + c]);
                out.push_back(static_cast<std::uint32_t>(bits));
                out.push_back(static_cast<std::uint32_t>(bits >> 32));
            }
        }
    }
    return out;
}

void unpack(const std::vector<std::uint32_t>& words, RenderState& s) {
    std::size_t at = 0;
    const std::size_t pixels = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
    for (std::size_t i = 0; i < pixels; ++i) {
        at += 3;
        for (std::size_t h = 0; h < static_cast<std::size_t>(s.halves); ++h) {
            s.samples[h][i] = words[at++];
            for (std::size_t c = 0; c < 3; ++c, at += 2) {
                s.sums[h][3 * i + c] =
                    std::bit_cast<double>(words[at] | (static_cast<std::uint64_t>(words[at + 1]) << 32));
            }
        }
    }
}

std::string checksum(const std::vector<std::uint32_t>& words) {
    return fmt::format("{:016x}", XXH3_64bits(words.data(), words.size() * sizeof(std::uint32_t)));
}

}  // namespace

RenderState::RenderState(int w, int h, int count, double stops)
    : width(w), height(h), halves(count), exposure_stops(stops) {
    const std::size_t pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        sums[i].assign(3 * pixels, 0);
        samples[i].assign(pixels, 0);
    }
}

std::uint64_t RenderState::bytes(int width, int height, int halves) {
    // Memory of the sums and counts, of the words of their file, and of two images.
    const auto pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    return pixels * (28 * static_cast<std::uint64_t>(halves) + 4 * words_per_pixel(halves) + 24);
}

Image RenderState::picture() const {
    Image out(width, height);
    out.exposure_stops = exposure_stops;
    for (std::size_t i = 0; i < samples[0].size(); ++i) {
        double count = samples[0][i];
        if (halves == 2) count += samples[1][i];
        if (count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = sums[0][3 * i + c];
            if (halves == 2) sum += sums[1][3 * i + c];
            out.rgb[3 * i + c] = static_cast<float>(sum / count);
        }
    }
    return out;
}

Image RenderState::half(int which) const {
    Image out(width, height);
    out.exposure_stops = exposure_stops;
    const auto h = static_cast<std::size_t>(which);
    for (std::size_t i = 0; i < samples[h].size(); ++i) {
        if (samples[h][i] == 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
            out.rgb[3 * i + c] = static_cast<float>(sums[h][3 * i + c] / samples[h][i]);
    }
    return out;
}

void write_state(const std::filesystem::path& path, const RenderState& state, const std::string& settings) {
    OutputFile file(path);
    const std::vector<std::uint32_t> words = pack(state);
    FlatExr exr;
    exr.display = exr.data = {0, 0, state.width - 1, state.height - 1};
    exr.channels = channels(state.halves, words.data());
    exr.pixel_bytes = sizeof(std::uint32_t) * words_per_pixel(state.halves);
    exr.row_bytes = exr.pixel_bytes * static_cast<std::size_t>(state.width);
    exr.compression = ChunkCompression::none;  // the low bits of the sums do not compress
    exr.texts = {{settings_attribute, settings}, {checksum_attribute, checksum(words)}};
    write_flat_exr(file.temporary_path(), path.string(), exr);
    file.commit();
}

void read_state(const std::filesystem::path& path, const std::string& settings, RenderState& state) {
    const auto bad = [&](const std::string& what) {
        fail(ExitCode::invalid_input,
             "{}: cannot go on from this file: {} (without --resume it is made anew)", path.string(), what);
    };
    try {
        check_exr_headers(path);
    } catch (const Error& e) {
        bad(e.what());
    }
    std::unique_ptr<Imf::InputFile> in;
    try {
        in = std::make_unique<Imf::InputFile>(path.c_str());
    } catch (const std::exception&) {
        bad("it is no picture that an interrupted run left");
    }
    const Imf::Header& header = in->header();
    const std::string found = text_of(header, settings_attribute);
    if (found.empty()) bad("it is no picture that an interrupted run left");
    if (found != settings) bad(fmt::format("other settings (got {}; expected {})", found, settings));
    const Imath::Box2i& window = header.dataWindow();
    if (window != Imath::Box2i({0, 0}, {state.width - 1, state.height - 1}))
        bad("its size does not fit its settings");
    std::vector<std::uint32_t> words(words_per_pixel(state.halves) * static_cast<std::size_t>(state.width) *
                                     static_cast<std::size_t>(state.height));
    const std::size_t pixel_bytes = sizeof(std::uint32_t) * words_per_pixel(state.halves);
    Imf::FrameBuffer buffer;
    std::size_t at = 0;
    for (const FlatExr::Channel& wanted : channels(state.halves, nullptr)) {
        const auto type = wanted.type == ExrChannel::Type::float32 ? Imf::FLOAT : Imf::UINT;
        const Imf::Channel* channel = header.channels().findChannel(wanted.name);
        if (channel == nullptr || channel->type != type || channel->xSampling != 1 || channel->ySampling != 1)
            bad("channels are missing");
        buffer.insert(wanted.name, Imf::Slice(type, reinterpret_cast<char*>(words.data() + at++), pixel_bytes,
                                              pixel_bytes * static_cast<std::size_t>(state.width)));
    }
    try {
        in->setFrameBuffer(buffer);
        in->readPixels(0, state.height - 1);
    } catch (const std::exception& e) {
        bad(fmt::format("damaged: {}", e.what()));
    }
    if (checksum(words) != text_of(header, checksum_attribute)) bad("damaged: its checksum is wrong");
    unpack(words, state);
}

}  // namespace postlens
