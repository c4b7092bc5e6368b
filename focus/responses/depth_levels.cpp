#include "focus/responses/depth_levels.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace postlens {
namespace {

/// Blur kernels are computed only for certain depths, the depth levels. If the levels are equally spaced in
/// depth, they must be so close that the CoC diameters of two neighbouring levels differ by at most this, in
/// px. This determines their number.
constexpr double linear_step_px = 0.99;

double clamped_radius_px(double diameter_px) {
    return std::clamp(std::abs(diameter_px) / 2, DepthLevels::smallest_radius_px,
                      DepthLevels::largest_radius_px);
}

/// Returns how many equally spaced depth levels (depths for which blur kernels are computed) are needed.
/// Rounding a depth to the nearest level may change the CoC diameter by at most half of linear_step_px. Only
/// the nearest depth is considered, because the diameter changes most there.
int linear_depths(double coc_gain_px_m, double nearest_m, double farthest_m) {
    // Computes the step between depth levels. Rounding a depth z changes it by at most half a step, h
    // (`half_step_m`), which changes the CoC diameter by
    //
    //     coc_gain_px_m (1 / z - 1 / (z + h))
    //
    // where coc_gain_px_m is a constant of the lens, in px m. The step is chosen so that this equals
    // linear_step_px / 2 at the nearest depth. `room` is the resulting 1 / (z + h).
    const double room = 1 / nearest_m - linear_step_px / 2 / coc_gain_px_m;
    if (room <= 0) return 2;
    const double half_step_m = 1 / room - nearest_m;
    const double wanted = std::ceil((farthest_m - nearest_m) / (2 * half_step_m)) + 1;
    return static_cast<int>(std::clamp(wanted, 2.0, static_cast<double>(DepthLevels::most_linear_levels)));
}

}  // namespace

DepthRange depth_range(const SampleFileReader& file) {
    DepthRange out;
    for (const ScanlineFacts& facts : file.scanlines()) {
        if (std::isinf(facts.nearest_z)) continue;
        const double nearest_m = facts.nearest_z, farthest_m = facts.farthest_z;
        out.nearest_m = std::min(out.nearest_m.value_or(nearest_m), nearest_m);
        out.farthest_m = std::max(out.farthest_m.value_or(farthest_m), farthest_m);
    }
    return out;
}

double largest_coc_px(const DepthRange& range, const FocusGeometry& geometry) {
    double out = 0;
    for (const auto& z : {range.nearest_m, range.farthest_m}) {
        if (z) out = std::max(out, std::abs(geometry.coc_diameter_px(1 / *z)));
    }
    return out;
}

DepthLevels::DepthLevels(const FocusGeometry& geometry, const DepthRange& range, DepthSpacing spacing,
                         std::optional<int> depths)
    : geometry_(geometry), spacing_(spacing), around_focus_(!depths && spacing == DepthSpacing::inverse) {
    if (depths && (*depths < 2 || *depths > most_depths)) {
        fail(ExitCode::wrong_arguments, "number of depths is out of range (got {}; expected 2 to {})",
             *depths, most_depths);
    }
    if (around_focus_) {
        lay_around_focus();
    } else {
        lay_from_nearest(range, depths);
    }
}

void DepthLevels::lay_around_focus() {
    const std::uint32_t last = LevelTable::nearest_level(2 * largest_radius_px);
    for (std::uint32_t i = 0; i <= last; ++i) {
        radius_px_.push_back(clamped_radius_px(LevelTable::diameter_px(i)));
    }
}

void DepthLevels::lay_from_nearest(const DepthRange& range, std::optional<int> depths) {
    depths_ = depths.value_or(2);
    if (range.nearest_m && range.farthest_m) {
        const double nearest_m = *range.nearest_m, farthest_m = *range.farthest_m;
        const double coc_gain_px_m = 2 * geometry_.aperture_radius_m * geometry_.gain_px;
        const int k = depths ? *depths : linear_depths(coc_gain_px_m, nearest_m, farthest_m);
        depths_ = k;
        const bool linear = spacing_ == DepthSpacing::linear;
        first_ = linear ? nearest_m : 1 / nearest_m;
        step_ = ((linear ? farthest_m : 1 / farthest_m) - first_) / (k - 1);
        finite_levels_ = step_ != 0 ? static_cast<std::uint32_t>(k) : 1;
        for (std::uint32_t i = 0; i < finite_levels_; ++i) {
            const double at = first_ + i * step_;
            radius_px_.push_back(clamped_radius_px(geometry_.coc_diameter_px(linear ? 1 / at : at)));
        }
    }
    infinite_level_ = static_cast<std::uint32_t>(radius_px_.size());
    radius_px_.push_back(clamped_radius_px(geometry_.coc_diameter_px(0)));
}

std::optional<std::uint32_t> DepthLevels::level_from_nearest(double inverse_depth_per_m) const {
    if (inverse_depth_per_m == 0) return infinite_level_;
    if (finite_levels_ == 0 || inverse_depth_per_m < 0) return std::nullopt;
    const double at = spacing_ == DepthSpacing::linear ? 1 / inverse_depth_per_m : inverse_depth_per_m;
    // The depth `at` may lie outside the range of the depth levels. They cover only the depths of surfaces
    // that are seen directly, but a reflection or refraction may lie at another depth. For depths outside the
    // range, this function returns nothing.
    if (finite_levels_ == 1) {
        if (std::abs(at - first_) > 1e-6 * first_) return std::nullopt;
        return 0;
    }
    const double index = std::round((at - first_) / step_);
    if (index < 0 || index >= finite_levels_) return std::nullopt;
    return static_cast<std::uint32_t>(index);
}

}  // namespace postlens
