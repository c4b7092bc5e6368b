// Writes the pinhole image of a sample file as another program's renderer would: as a flat OpenEXR file with
// one depth per pixel and optional ids, or as a deep one with a sample per surface and its id. The tables of
// scripts/ use it.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pictures/foreign/cryptomatte.h"
#include "records/quadtree.h"
#include "records/sample_file.h"

namespace {

using namespace postlens;

/// Greatest number of surfaces per pixel in a Cryptomatte with two layers of channels.
constexpr std::size_t ranks = 4;

/// A surface in a pixel: its share of the pixel, and the sums of share times z', m, and of share times
/// colour.
struct Part {
    double share = 0, depth = 0;
    std::array<double, 3> rgb{};
};

class Picture {
  public:
    explicit Picture(const SampleFileReader& file)
        : header_(file.header()),
          rgb_(file.picture()),
          parts_(static_cast<std::size_t>(header_.width) * static_cast<std::size_t>(header_.height)) {
        RecordBand band;
        file.read(file.y_begin(), file.y_end(), band);
        PointSamples found;
        find_point_samples(band, file.y_begin(), file.y_end(), file.y_begin(), file.y_end() - 1, found);
        for (const PointSample& s : found.samples) add(s, band.records[s.first_record]);
    }

    /// `depth`: "most" writes the depth of the surface with the largest share of a pixel, "mean" the mean
    /// depth of all its surfaces. `ids`: "none", "id" or "cryptomatte".
    void write(const std::string& path, const std::string& depth, const std::string& ids) const;

    /// The deep image. The colour of a surface is that of its first hits: reflections and refractions are
    /// left out.
    void write_deep(const std::string& path) const;

  private:
    using Ranked = std::vector<std::pair<std::uint32_t, Part>>;

    // Adds a sample to the up to four pixels that its footprint covers; each quadrant of the footprint lies
    // in one pixel.
    void add(const PointSample& s, const Record& node) {
        for (std::size_t q = 0; q < s.weight.size(); ++q) {
            if (!(s.weight[q] > 0)) continue;
            const int x = static_cast<int>(q % 2 == 0 ? std::ceil(s.x) - 1 : std::floor(s.x)),
                      y = static_cast<int>(q < 2 ? std::ceil(s.y) - 1 : std::floor(s.y));
            if (x < 0 || x >= header_.width || y < 0 || y >= header_.height) continue;
            Part& part = parts_[static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
                                static_cast<std::size_t>(x)][node.id];
            part.share += static_cast<double>(s.weight[q]);
            part.depth += static_cast<double>(s.weight[q]) * static_cast<double>(node.z);
            for (std::size_t c = 0; c < 3; ++c)
                part.rgb[c] += static_cast<double>(s.weight[q]) *
                               static_cast<double>(std::array{node.r, node.g, node.b}[c]);
        }
    }
    /// The surfaces of a pixel, sorted by falling share.
    [[nodiscard]] Ranked ranked(std::size_t pixel) const {
        Ranked out(parts_[pixel].begin(), parts_[pixel].end());
        std::stable_sort(out.begin(), out.end(),
                         [](const auto& a, const auto& b) { return a.second.share > b.second.share; });
        return out;
    }

    [[nodiscard]] Imf::Header exr_header() const {
        Imf::Header out(header_.width, header_.height);
        const auto pitch_mm = static_cast<float>(header_.pixel_pitch_mm);
        out.insert("pinholeFocalLength", Imf::FloatAttribute(static_cast<float>(header_.film_distance_mm)));
        out.insert("sensorOverallDimensions",
                   Imf::V2fAttribute({pitch_mm * static_cast<float>(header_.width),
                                      pitch_mm * static_cast<float>(header_.height)}));
        return out;
    }

    const SampleHeader& header_;
    Image rgb_;
    std::vector<std::map<std::uint32_t, Part>> parts_;  ///< index: pixel, key: id
};

void Picture::write(const std::string& path, const std::string& depth, const std::string& ids) const {
    std::map<std::string, std::vector<float>> channels;
    const auto set = [&](const std::string& name, std::size_t pixel, float value) {
        auto& values = channels[name];
        values.resize(parts_.size());
        values[pixel] = value;
    };
    std::map<std::uint32_t, std::uint32_t> hashed{{0, 0}};  // id 0 is what no object covers
    nlohmann::json manifest = nlohmann::json::object();
    for (const auto& [id, name] : header_.object_names) {
        hashed[id] = cryptomatte_id(name);
        manifest[name] = fmt::format("{:08x}", hashed[id]);
    }
    for (std::size_t pixel = 0; pixel < parts_.size(); ++pixel) {
        for (std::size_t c = 0; c < 3; ++c) set(std::string(1, "RGB"[c]), pixel, rgb_.rgb[3 * pixel + c]);
        const Ranked surfaces = ranked(pixel);
        Part of_depth = surfaces.front().second;
        if (depth == "mean") {
            of_depth = {};
            for (const auto& [id, part] : surfaces)
                of_depth = {of_depth.share + part.share, of_depth.depth + part.depth, {}};
        }
        set("Z", pixel, static_cast<float>(of_depth.depth / of_depth.share));
        if (ids == "id") set("id", pixel, static_cast<float>(surfaces.front().first + 1));
        if (ids != "cryptomatte") continue;
        for (std::size_t i = 0; i < ranks; ++i) {
            const std::string layer = fmt::format("CryptoObject{:02}.", i / 2);
            const std::uint32_t hash = i < surfaces.size() ? hashed[surfaces[i].first] : 0;
            set(layer + (i % 2 == 0 ? "R" : "B"), pixel, std::bit_cast<float>(hash));
            set(layer + (i % 2 == 0 ? "G" : "A"), pixel,
                i < surfaces.size() ? static_cast<float>(surfaces[i].second.share) : 0.0F);
        }
    }
    Imf::Header header = exr_header();
    if (ids == "cryptomatte") {
        for (const auto& [key, text] : std::map<std::string, std::string>{{"name", "CryptoObject"},
                                                                          {"hash", "MurmurHash3_32"},
                                                                          {"conversion", "uint32_to_float32"},
                                                                          {"manifest", manifest.dump()}})
            header.insert("cryptomatte/1234567/" + key, Imf::StringAttribute(text));
    }
    Imf::FrameBuffer frame;
    for (auto& [name, values] : channels) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                      sizeof(float) * static_cast<std::size_t>(header_.width)));
    }
    Imf::OutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(header_.height);
}

void Picture::write_deep(const std::string& path) const {
    constexpr std::array<const char*, 6> names{"R", "G", "B", "A", "Z", "id"};
    std::array<std::vector<float>, names.size()> values;
    std::vector<unsigned> counts;
    std::vector<std::size_t> first;
    for (std::size_t pixel = 0; pixel < parts_.size(); ++pixel) {
        Ranked surfaces = ranked(pixel);
        const auto depth_of = [](const auto& surface) { return surface.second.depth / surface.second.share; };
        std::stable_sort(surfaces.begin(), surfaces.end(),
                         [&](const auto& a, const auto& b) { return depth_of(a) < depth_of(b); });
        first.push_back(values[0].size());
        // Share of the pixel that nearer surfaces leave. Alphas are relative to it, as "over" multiplies them
        // by it.
        double left = 1;
        for (const auto& [id, part] : surfaces) {
            constexpr double least_share = 1e-6;
            if (id == 0 || left < least_share) continue;
            const double alpha = std::min(part.share / left, 1.0);
            for (std::size_t c = 0; c < 3; ++c) values[c].push_back(static_cast<float>(part.rgb[c] / left));
            values[3].push_back(static_cast<float>(alpha));
            values[4].push_back(static_cast<float>(part.depth / part.share));
            values[5].push_back(static_cast<float>(id));
            left *= 1 - alpha;
        }
        counts.push_back(static_cast<unsigned>(values[0].size() - first.back()));
    }
    Imf::Header header = exr_header();
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    for (const char* name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    const auto width = static_cast<std::size_t>(header_.width);
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                            sizeof(unsigned), sizeof(unsigned) * width));
    std::array<std::vector<float*>, names.size()> pointers;
    for (std::size_t c = 0; c < names.size(); ++c) {
        for (const std::size_t i : first) pointers[c].push_back(values[c].data() + i);
        frame.insert(names[c], Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers[c].data()),
                                              sizeof(float*), sizeof(float*) * width, sizeof(float)));
    }
    Imf::DeepScanLineOutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(header_.height);
}

int usage() {
    std::fputs(
        "foreign_export FRAME.exr OUT.exr most|mean none|id|cryptomatte\n"
        "foreign_export FRAME.exr OUT.exr deep\n",
        stderr);
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv, argv + argc);
    const auto one_of = [](const std::string& word, std::initializer_list<const char*> expected) {
        return std::find(expected.begin(), expected.end(), word) != expected.end();
    };
    const bool deep = argc == 4 && words[3] == "deep";
    const bool flat =
        argc == 5 && one_of(words[3], {"most", "mean"}) && one_of(words[4], {"none", "id", "cryptomatte"});
    if (!deep && !flat) return usage();
    try {
        const SampleFileReader file(words[1]);
        const Picture picture(file);
        if (deep) {
            picture.write_deep(words[2]);
        } else {
            picture.write(words[2], words[3], words[4]);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "foreign_export: {}\n", error.what());
        return 1;
    }
    return 0;
}
