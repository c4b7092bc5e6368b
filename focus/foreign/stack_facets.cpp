#include "focus/foreign/stack_facets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/memory.h"
#include "core/sample_hash.h"
#include "core/threads.h"

namespace postlens {

bool are_one_surface(const StackSample& a, const StackSample& b, const FocusGeometry& geometry) {
    if (a.id != 0 && b.id != 0 && a.id != b.id) return false;
    constexpr double least_step_px = 1, share = 1.0 / 16;
    const auto radius_px = [&](const StackSample& s) {
        return geometry.coc_diameter_px(static_cast<double>(s.spread_inverse_z())) / 2;
    };
    const double ra = radius_px(a), rb = radius_px(b);
    return std::abs(ra - rb) < std::max(least_step_px, share * std::min(std::abs(ra), std::abs(rb)));
}

Facets::Facets(const ForeignPicture& p, const std::vector<Behind>& behind, const BorderExtension& border,
               const FocusGeometry& geometry)
    : x_begin(border.window().x_begin),
      y_begin(border.window().y_begin),
      width(border.window().width()),
      height(border.window().height()),
      geometry_(geometry) {
    const auto is_seen_behind = [&](std::size_t pixel) {
        return !behind.empty() && behind[pixel].known && behind[pixel].weight > 0;
    };
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const auto place = [&](std::size_t i) {
        return std::pair(x_begin + static_cast<int>(i % static_cast<std::size_t>(width)),
                         y_begin + static_cast<int>(i / static_cast<std::size_t>(width)));
    };
    std::vector<StackSample> continued;
    std::size_t count = p.samples.size();
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto [x, y] = place(i);
        const bool stored = p.stores(x, y);
        const auto source = stored ? std::optional(p.pixel_at(x, y)) : border.continued(x, y, continued);
        if (source) count += (stored ? 0 : continued.size()) + (is_seen_behind(*source) ? 1 : 0);
    }
    require_memory(count * sizeof(Facet) + (pixels + 1) * sizeof(std::uint64_t),
                   "the samples as views draw them");
    facets_.reserve(count);
    offsets_.reserve(pixels + 1);
    offsets_.push_back(0);
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto [x, y] = place(i);
        const bool stored = p.stores(x, y);
        const auto source = stored ? std::optional(p.pixel_at(x, y)) : border.continued(x, y, continued);
        if (source) {
            const std::span<const StackSample> stack = stored ? p.stack(x, y) : continued;
            const std::size_t number = stored ? *source : p.offsets.size() + i;
            for (const StackSample& s : stack) add(number, s, !stored);
            if (is_seen_behind(*source)) {
                const Behind& b = behind[*source];
                add(number,
                    {.inverse_z = b.inverse_z,
                     .r = b.r,
                     .g = b.g,
                     .b = b.b,
                     .alpha = b.alpha,
                     .id = b.id,
                     .moved_inverse_z = b.spread_inverse_z,
                     .holdout = b.holdout},
                    !stored);
            }
        }
        offsets_.push_back(facets_.size());
    }
    join_neighbours();
    find_ranges();
}

void Facets::add(std::size_t number, const StackSample& s, bool beyond) {
    Facet f;
    f.inverse_z.fill(s.spread_inverse_z());
    f.sample = s;
    f.layer = static_cast<std::uint32_t>(facets_.size() - offsets_.back());
    f.seed = random_word(number, f.layer);
    f.beyond = beyond;
    facets_.push_back(f);
}

const Facet* Facets::continued(const Facet& f, int x, int y) const {
    if (x < 0 || x >= width || y < 0 || y >= height) return nullptr;
    const Facet* best = nullptr;
    float apart = std::numeric_limits<float>::infinity();
    for (const Facet& other :
         at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))) {
        const float d = std::abs(other.sample.spread_inverse_z() - f.sample.spread_inverse_z());
        if (d < apart && are_one_surface(f.sample, other.sample, geometry_)) {
            apart = d;
            best = &other;
        }
    }
    return best;
}

void Facets::join_neighbours() {
    parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < width; ++x) {
            const std::size_t pixel = row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            for (std::uint64_t k = offsets_[pixel]; k < offsets_[pixel + 1]; ++k) join(facets_[k], x, y);
        }
    });
}

void Facets::join(Facet& f, int x, int y) const {
    std::array<const Facet*, 9> around{};
    for (int v = 0; v < 3; ++v) {
        for (int u = 0; u < 3; ++u) {
            if (u == 1 && v == 1) continue;
            around[3 * static_cast<std::size_t>(v) + static_cast<std::size_t>(u)] =
                continued(f, x + u - 1, y + v - 1);
        }
    }
    for (std::size_t corner = 0; corner < Facet::corners; ++corner) {
        const std::size_t u = 2 * (corner % 2), v = 2 * (corner / 2);
        auto sum = static_cast<double>(f.sample.spread_inverse_z());
        int count = 1;
        for (const Facet* other : {around[3 + u], around[3 * v + 1], around[3 * v + u]}) {
            if (other == nullptr) continue;
            sum += static_cast<double>(other->sample.spread_inverse_z());
            ++count;
        }
        f.inverse_z[corner] = static_cast<float>(sum / count);
    }
}

void Facets::find_ranges() {
    ranges_.assign(static_cast<std::size_t>(height),
                   {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()});
    for (std::size_t row = 0; row < ranges_.size(); ++row) {
        auto& [least, most] = ranges_[row];
        for (std::uint64_t k = offsets_[row * static_cast<std::size_t>(width)];
             k < offsets_[(row + 1) * static_cast<std::size_t>(width)]; ++k) {
            for (const float z : facets_[k].inverse_z) {
                least = std::min(least, z);
                most = std::max(most, z);
            }
        }
    }
}

}  // namespace postlens
