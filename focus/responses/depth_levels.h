// Blur kernels are computed only for certain depths, the depth levels [potmesil1981]. The light of each
// sample in the file is spread by the kernel of the nearest level.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "focus/responses/level_table.h"
#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

enum class DepthSpacing {
    linear,   ///< equal steps in z', as in [potmesil1981]
    inverse,  ///< equal steps in 1/z', that is, equal steps of CoC
};

enum class DepthModel {
    ray_differentials,  ///< W, the 2x2 matrix of each node; reflections have the depth of their virtual image
    path,               ///< z' of each node, the path length of [potmesil1981]
    first_hit,          ///< z' of the primary node, for all nodes of its sample
};

/// Smallest and largest depth z' of the surfaces in a file, in m. z' is the path length from the eye along
/// the optical axis. Infinite depths do not count. Both values are absent if no ray hit anything.
struct DepthRange {
    std::optional<double> nearest_m, farthest_m;
};

[[nodiscard]] DepthRange depth_range(const SampleFileReader& file);
/// Returns the largest CoC diameter in the range, in px.
[[nodiscard]] double largest_coc_px(const DepthRange& range, const FocusGeometry& geometry);

/// The depths for which blur kernels are computed [potmesil1981]. Each sample uses the kernel of the nearest
/// depth.
class DepthLevels {
  public:
    static constexpr int most_depths = 4096;
    static constexpr int most_linear_levels = 256;
    /// CoC radius, in px, of a point in focus. It is not 0, so that the disc has an area, but the disc lies
    /// within one pixel.
    static constexpr double smallest_radius_px = 1e-4;
    /// Largest CoC radius, in px. A larger radius is reduced to this one. The error is invisible, because a
    /// disc of this radius adds less than 1e-10 of a sample's light to any pixel.
    static constexpr double largest_radius_px = LevelTable::largest_diameter_px / 2;

    /// Throws Error(wrong_arguments) if `depths`, the number of depths for which kernels are computed, is not
    /// in the range from 2 to most_depths. If it is absent, the number is chosen automatically.
    DepthLevels(const FocusGeometry& geometry, const DepthRange& range, DepthSpacing spacing,
                std::optional<int> depths);

    /// Blur kernels are computed for certain depths, the depth levels. Returns the number of the level
    /// nearest to an inverse depth in 1/m (0: infinitely far), or nothing outside the range of the levels.
    [[nodiscard]] std::optional<std::uint32_t> level_of(double inverse_depth_per_m) const {
        if (around_focus_) return table_->level_of(geometry_.coc_diameter_px(inverse_depth_per_m));
        return level_from_nearest(inverse_depth_per_m);
    }
    /// Blur kernels are computed for certain depths, the depth levels. Returns true if the levels become
    /// denser towards the focus distance, as in LevelTable, and false if they are equally spaced in depth or
    /// inverse depth.
    [[nodiscard]] bool around_focus() const { return around_focus_; }
    /// Sets level[i] to the number of the depth level nearest to inverse_depth_per_m[i], for all i. A depth
    /// level is a depth for which a blur kernel is computed. Call this only if around_focus() is true, that
    /// is, if the levels become denser towards the focus.
    void levels_of(std::span<const double> inverse_depth_per_m, std::uint32_t* level) const {
        table_->levels_of(geometry_, inverse_depth_per_m.data(), inverse_depth_per_m.size(), level);
    }
    /// CoC radius of each depth level, in px.
    [[nodiscard]] const std::vector<double>& radius_px() const { return radius_px_; }
    /// Returns for how many depths, except infinity, blur kernels are computed. Returns nothing if these
    /// depths are neither equally spaced in depth nor in inverse depth.
    [[nodiscard]] std::optional<int> depths() const { return depths_; }

  private:
    void lay_around_focus();
    void lay_from_nearest(const DepthRange& range, std::optional<int> depths);
    [[nodiscard]] std::optional<std::uint32_t> level_from_nearest(double inverse_depth_per_m) const;

    const LevelTable* table_ = &LevelTable::the();
    FocusGeometry geometry_;
    DepthSpacing spacing_;
    bool around_focus_;
    double first_ = 0;  ///< 1/z' or z' of level 0
    double step_ = 0;
    std::uint32_t finite_levels_ = 0;
    std::uint32_t infinite_level_ = 0;
    std::vector<double> radius_px_;
    std::optional<int> depths_;
};

}  // namespace postlens
