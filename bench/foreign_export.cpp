// Writes the pinhole image of a sample file as another program's renderer would: as a flat OpenEXR file with
// one depth per pixel and optional ids. scripts/ids_table.py uses it.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <string>
#include <vector>

#include "pictures/foreign/cryptomatte.h"
#include "records/quadtree.h"
#include "records/sample_file.h"

namespace {

using namespace postlens;

/// Greatest number of surfaces per pixel in a Cryptomatte with two layers of channels.
constexpr std::size_t ranks = 4;

/// A surface in a pixel: its share of the pixel, and the sum of share times z', m.
struct Part {
    double share = 0, depth = 0;
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
        }
    }
    /// The surfaces of a pixel, sorted by falling share.
    [[nodiscard]] Ranked ranked(std::size_t pixel) const {
        Ranked out(parts_[pixel].begin(), parts_[pixel].end());
        std::stable_sort(out.begin(), out.end(),
                         [](const auto& a, const auto& b) { return a.second.share > b.second.share; });
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
    std::map<std::uint32_t, std::uint32_t> hashed;
    for (std::size_t pixel = 0; pixel < parts_.size(); ++pixel) {
        for (std::size_t c = 0; c < 3; ++c) set(std::string(1, "RGB"[c]), pixel, rgb_.rgb[3 * pixel + c]);
        const Ranked surfaces = ranked(pixel);
        Part of_depth = surfaces.front().second;
        if (depth == "mean") {
            of_depth = {};
            for (const auto& [id, part] : surfaces)
                of_depth = {of_depth.share + part.share, of_depth.depth + part.depth};
        }
        set("Z", pixel, static_cast<float>(of_depth.depth / of_depth.share));
        if (ids == "id") set("id", pixel, static_cast<float>(surfaces.front().first + 1));
        if (ids != "cryptomatte") continue;
        for (std::size_t i = 0; i < ranks; ++i) {
            const std::string layer = fmt::format("CryptoObject{:02}.", i / 2);
            std::uint32_t hash = 0;
            if (i < surfaces.size()) {
                const auto [at, is_new] = hashed.try_emplace(surfaces[i].first);
                if (is_new) at->second = cryptomatte_id(fmt::format("object_{}", at->first));
                hash = at->second;
            }
            set(layer + (i % 2 == 0 ? "R" : "B"), pixel, std::bit_cast<float>(hash));
            set(layer + (i % 2 == 0 ? "G" : "A"), pixel,
                i < surfaces.size() ? static_cast<float>(surfaces[i].second.share) : 0.0F);
        }
    }
    Imf::Header header(header_.width, header_.height);
    const auto pitch_mm = static_cast<float>(header_.pixel_pitch_mm);
    header.insert("pinholeFocalLength", Imf::FloatAttribute(static_cast<float>(header_.film_distance_mm)));
    header.insert("sensorOverallDimensions",
                  Imf::V2fAttribute({pitch_mm * static_cast<float>(header_.width),
                                     pitch_mm * static_cast<float>(header_.height)}));
    if (ids == "cryptomatte") {
        for (const auto& [key, text] : std::map<std::string, std::string>{
                 {"name", "CryptoObject"}, {"hash", "MurmurHash3_32"}, {"conversion", "uint32_to_float32"}})
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

int usage() {
    std::fputs("foreign_export FRAME.exr OUT.exr most|mean none|id|cryptomatte\n", stderr);
    return 2;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv, argv + argc);
    const auto one_of = [](const std::string& word, std::initializer_list<const char*> expected) {
        return std::find(expected.begin(), expected.end(), word) != expected.end();
    };
    if (argc != 5 || !one_of(words[3], {"most", "mean"}) || !one_of(words[4], {"none", "id", "cryptomatte"}))
        return usage();
    try {
        const SampleFileReader file(words[1]);
        Picture(file).write(words[2], words[3], words[4]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "foreign_export: {}\n", error.what());
        return 1;
    }
    return 0;
}
