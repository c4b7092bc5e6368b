#include "focus/foreign/stack_lights.h"

#include <algorithm>
#include <cmath>

#include "focus/layers/visibility.h"

namespace postlens {
namespace {

/// Samples are composited with at least this alpha. A sample that emits light but hides nothing, such as a
/// flame, has an alpha of 0, so it would get no weight and its light would be lost. This value is so small
/// that even many such samples hide almost nothing.
constexpr double least_alpha = 1e-7;
/// Smaller shares of a pixel are considered rounding errors.
constexpr double least_share = 1e-6;

}  // namespace

std::uint32_t StackLights::surface_of(double signed_radius_px) {
    constexpr double even_to_px = 16;
    const double size = std::abs(signed_radius_px);
    const double steps = size <= even_to_px
                             ? std::floor(size + 0.5)
                             : even_to_px + std::floor(even_to_px * std::log(size / even_to_px));
    constexpr double middle = 1 << 20;
    return static_cast<std::uint32_t>(middle + std::copysign(std::min(steps, middle / 2), signed_radius_px));
}

void StackLights::add_surface(std::uint32_t surface, const Depths& depths, const std::array<double, 3>& rgb,
                              double alpha, bool behind_all) {
    auto sum = std::find_if(sums_.begin(), sums_.end(), [&](const Sum& s) { return s.surface == surface; });
    if (sum == sums_.end()) {
        sums_.emplace_back().surface = surface;
        sum = sums_.end() - 1;
    }
    const double radius_px = geometry_.coc_diameter_px(depths.spread) / 2;
    const double seen = behind_all ? 0 : left_, hidden = std::max(0.0, sum->left - seen);
    const bool opaque = behind_all || left_ <= least_share;
    double covered = 0, covering = 0;
    for (const Met& m : met_) {
        if (m.surface == surface) continue;
        const double apart = surface == nothing ? 1
                             : opaque           ? std::min(1.0, std::abs(radius_px - m.radius_px))
                                                : independence(radius_px, m.radius_px);
        covered += m.seen * (1 - apart);
        covering += m.seen;
    }
    if (covering > 0) covered *= hidden / covering;
    for (std::size_t c = 0; c < 3; ++c) {
        sum->seen[c] += seen * rgb[c];
        sum->hidden[c] += hidden * rgb[c];
    }
    sum->seen_weight += seen * alpha;
    sum->hidden_weight += hidden * alpha;
    sum->covered += covered * alpha;
    sum->seen_depths.order += seen * alpha * depths.order;
    sum->seen_depths.spread += seen * alpha * depths.spread;
    sum->hidden_depths.order += hidden * alpha * depths.order;
    sum->hidden_depths.spread += hidden * alpha * depths.spread;
    sum->left *= 1 - alpha;
    if (behind_all) return;
    met_.push_back({surface, radius_px, left_ * alpha});
    left_ *= 1 - alpha;
}

void StackLights::add(int x, std::span<const StackSample> stack, bool fills, double open,
                      const Behind* behind, StackValue value, std::vector<PixelLight>& out) {
    const bool behind_known = behind != nullptr && behind->known;
    if (stack.size() == 1 && stack[0].alpha == 1 && !stack[0].holdout && !behind_known &&
        (fills || open <= opaque_transmittance) && value == StackValue::colour) {
        // Shortcut: most pixels show one opaque surface, far from any edge.
        const StackSample& s = stack[0];
        const auto spread = static_cast<double>(s.spread_inverse_z());
        out.push_back({.x = x,
                       .inverse_depth = static_cast<double>(s.inverse_z),
                       .spread_depth = spread,
                       .rgb = {s.r, s.g, s.b},
                       .surface = surface_at(spread)});
        return;
    }
    left_ = 1;
    met_.clear();
    sums_.clear();
    const auto rgb_of = [&](const auto& s, double alpha) {
        return value == StackValue::alpha
                   ? std::array{alpha, alpha, alpha}
                   : std::array{static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b)};
    };
    const std::array<double, 3> none{};
    for (const StackSample& s : stack) {
        const bool last = &s == &stack.back();
        const double alpha = fills && last ? 1 : std::max(static_cast<double>(s.alpha), least_alpha);
        const Depths depths{static_cast<double>(s.inverse_z), static_cast<double>(s.spread_inverse_z())};
        add_surface(surface_at(depths.spread), depths,
                    s.holdout ? none : rgb_of(s, static_cast<double>(s.alpha)), alpha, false);
    }
    if (left_ > least_share) {
        add_surface(nothing, {}, {}, 1, false);
    } else if (behind_known) {
        const Depths depths{static_cast<double>(behind->inverse_z),
                            static_cast<double>(behind->spread_inverse_z)};
        const auto weight = static_cast<double>(behind->weight);
        if (weight > least_share) {
            const auto alpha = static_cast<double>(behind->alpha);
            add_surface(surface_at(depths.spread), depths, behind->holdout ? none : rgb_of(*behind, alpha),
                        weight, true);
        }
        if (weight < 1 - least_share) add_surface(nothing, {}, {}, 1 - weight, true);
    } else if (!fills && open > opaque_transmittance) {
        add_surface(nothing, {}, {}, open, true);
    }
    for (const Sum& s : sums_) {
        if (s.surface == nothing && !with_nothing_) continue;
        const auto store = [&](const std::array<double, 3>& rgb, double weight, const Depths& depths,
                               double covered, bool hidden) {
            if (!(weight > least_share * least_alpha)) return;
            out.push_back(
                {x,
                 depths.order / weight,
                 s.surface == nothing ? geometry_.inverse_focus_per_m : depths.spread / weight,
                 {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])},
                 static_cast<float>(weight),
                 static_cast<float>(covered),
                 s.surface,
                 hidden});
        };
        store(s.seen, s.seen_weight, s.seen_depths, 0, false);
        // Skips hidden light that no lens point sees.
        if (s.covered < s.hidden_weight * (1 - least_share))
            store(s.hidden, s.hidden_weight, s.hidden_depths, s.covered, true);
    }
}

}  // namespace postlens
