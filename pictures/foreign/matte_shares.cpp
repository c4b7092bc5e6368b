#include "pictures/foreign/matte_shares.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/memory.h"
#include "pictures/foreign/foreign_planes.h"

namespace postlens {
namespace {

/// Smallest share of a pixel at which a surface is kept; smaller shares are omitted.
constexpr float least_share = 0.01F;

struct MatteEntry {
    std::size_t pixel;
    SurfaceShare share;
};

/// Returns the shares of all pixels, with the values of the file, sorted by pixel.
std::vector<MatteEntry> matte_entries(const ForeignFile& file, const ForeignPart& onto,
                                      const Cryptomatte& matte) {
    const std::size_t pixels =
        static_cast<std::size_t>(onto.width()) * static_cast<std::size_t>(onto.height());
    std::vector<MatteEntry> out;
    std::vector<std::size_t> parts;
    for (const MatteRank& rank : matte.ranks) {
        if (std::find(parts.begin(), parts.end(), rank.part) == parts.end()) parts.push_back(rank.part);
    }
    for (const std::size_t other : parts) {
        std::vector<std::string> names;
        for (const MatteRank& rank : matte.ranks) {
            if (rank.part == other) names.insert(names.end(), {rank.id, rank.coverage});
        }
        each_row_onto(file, other, names, onto,
                      [&](std::size_t first, std::size_t count, std::size_t from,
                          std::span<const float* const> values) {
                          for (std::size_t i = 0; i < count; ++i) {
                              for (std::size_t c = 0; c < names.size(); c += 2) {
                                  const float share = values[c + 1][from + i];
                                  if (!(share >= least_share)) continue;  // also skips NaN
                                  if (out.size() == out.capacity()) {
                                      const std::size_t more = std::max(out.size() * 3 / 2, pixels);
                                      require_memory(more * sizeof(MatteEntry), "the Cryptomatte");
                                      out.reserve(more);
                                  }
                                  out.push_back({first + i,
                                                 {.id = surface_id(values[c][from + i], false),
                                                  .share = std::min(share, 1.0F),
                                                  .inverse_z = {}}});
                              }
                          }
                      });
    }
    if (parts.size() > 1) {
        std::stable_sort(out.begin(), out.end(),
                         [](const MatteEntry& a, const MatteEntry& b) { return a.pixel < b.pixel; });
    }
    return out;
}

void add_shares(std::size_t pixel, std::vector<SurfaceShare>& here, float sum, ForeignPicture& out) {
    if (1 - sum >= least_share) {
        const auto none =
            std::find_if(here.begin(), here.end(), [](const SurfaceShare& h) { return h.id == 0; });
        if (none != here.end()) {
            none->share += 1 - sum;
        } else {
            here.push_back({.id = 0, .share = 1 - sum, .inverse_z = {}});
        }
        sum = 1;
    }
    std::stable_sort(here.begin(), here.end(),
                     [](const SurfaceShare& a, const SurfaceShare& b) { return a.share > b.share; });
    for (std::uint64_t k = out.offsets[pixel]; k < out.offsets[pixel + 1]; ++k)
        out.samples[k].id = here[0].id;
    if (here.size() == 1) return;
    out.mixed.push_back({pixel, out.shares.size(), here.size()});
    for (const SurfaceShare& h : here)
        out.shares.push_back({.id = h.id, .share = h.share / sum, .inverse_z = {}});
}

}  // namespace

void take_matte(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte,
                ForeignPicture& picture) {
    const std::vector<MatteEntry> entries = matte_entries(file, onto, matte);
    require_memory(entries.size() * (sizeof(MixedPixel) + sizeof(SurfaceShare)), "the Cryptomatte");
    std::vector<SurfaceShare> here;
    for (std::size_t i = 0; i < entries.size();) {
        const std::size_t pixel = entries[i].pixel;
        here.clear();
        float sum = 0;
        for (; i < entries.size() && entries[i].pixel == pixel; ++i) {
            const SurfaceShare& s = entries[i].share;
            const auto same =
                std::find_if(here.begin(), here.end(), [&](const SurfaceShare& h) { return h.id == s.id; });
            if (same != here.end()) {
                same->share += s.share;
            } else {
                here.push_back(s);
            }
            sum += s.share;
        }
        add_shares(pixel, here, sum, picture);
    }
}

}  // namespace postlens
