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

/// Smallest fraction of a pixel at which a surface is kept.
constexpr float least_share = 0.01F;

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
    if (here.size() > 1) {
        std::stable_sort(here.begin(), here.end(),
                         [](const SurfaceShare& a, const SurfaceShare& b) { return a.share > b.share; });
    }
    for (std::uint64_t k = out.offsets[pixel]; k < out.offsets[pixel + 1]; ++k)
        out.samples[k].id = here[0].id;
    if (here.size() == 1) return;
    out.mixed.push_back({pixel, out.shares.size(), here.size()});
    for (const SurfaceShare& h : here)
        out.shares.push_back({.id = h.id, .share = h.share / sum, .inverse_z = {}});
}

}  // namespace

MatteShares::MatteShares(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte)
    : file_(file), onto_(onto), matte_(matte) {
    for (const MatteRank& rank : matte_.ranks) {
        if (std::find(parts_.begin(), parts_.end(), rank.part) == parts_.end()) parts_.push_back(rank.part);
    }
}

std::vector<std::string> MatteShares::channels(std::size_t part) const {
    std::vector<std::string> names;
    for (const MatteRank& rank : matte_.ranks) {
        if (rank.part == part) names.insert(names.end(), {rank.id, rank.coverage});
    }
    return names;
}

std::vector<std::string> MatteShares::begin_beside(std::size_t part) {
    if (parts_.empty() || parts_.front() != part) return {};
    taken_ = part;
    return channels(part);
}

void MatteShares::take(std::size_t pixel, std::size_t count, std::span<const float* const> values,
                       ForeignPicture& picture) {
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < values.size(); c += 2) {
            const float share = values[c + 1][i];
            if (!(share >= least_share)) continue;  // also skips NaN
            if (entries_.size() == entries_.capacity()) {
                const std::size_t more = std::max(entries_.size() * 3 / 2, count * values.size());
                require_memory(more * sizeof(Entry), "the Cryptomatte");
                entries_.reserve(more);
            }
            entries_.push_back(
                {pixel + i,
                 {.id = surface_id(values[c][i], false), .share = std::min(share, 1.0F), .inverse_z = {}}});
        }
    }
    if (parts_.size() == 1) add_entries(picture);
}

void MatteShares::finish(ForeignPicture& picture) {
    for (const std::size_t part : parts_) {
        if (part == taken_) continue;
        const std::vector<std::string> names = channels(part);
        std::vector<const float*> row(names.size());
        each_row_onto(file_, part, names, onto_,
                      [&](std::size_t first, std::size_t count, std::size_t from,
                          std::span<const float* const> values) {
                          for (std::size_t c = 0; c < row.size(); ++c) row[c] = values[c] + from;
                          take(first, count, row, picture);
                      });
    }
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry& a, const Entry& b) { return a.pixel < b.pixel; });
    add_entries(picture);
}

void MatteShares::add_entries(ForeignPicture& picture) {
    std::vector<SurfaceShare>& shares = picture.shares;
    if (shares.capacity() - shares.size() < entries_.size()) {
        const std::size_t more = std::max(shares.size() + entries_.size(), shares.capacity() * 3 / 2);
        require_memory(more * (sizeof(MixedPixel) + sizeof(SurfaceShare)), "the Cryptomatte");
        shares.reserve(more);
    }
    std::vector<SurfaceShare> here;
    for (std::size_t i = 0; i < entries_.size();) {
        const std::size_t pixel = entries_[i].pixel;
        here.clear();
        float sum = 0;
        for (; i < entries_.size() && entries_[i].pixel == pixel; ++i) {
            const SurfaceShare& s = entries_[i].share;
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
    entries_.clear();
}

}  // namespace postlens
