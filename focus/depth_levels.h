// The K impulse responses of 1981: which depths have one, and which one a sample uses.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "focus/level_table.h"
#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

enum class DepthSpacing {
    linear,   ///< equal steps in z', as in 1981
    inverse,  ///< equal steps in 1/z', that is, equal steps of CoC
};

enum class DepthModel {
    ray_differentials,  ///< W of each node: what mirrors and glass show keeps its own optical depth
    path,               ///< z' of each node: the path length of 1981
    first_hit,          ///< z' of the primary node for all nodes of its sample: what tools without trees do
};

/// What finite z' occur in a file; absent where nothing was hit.
struct DepthRange {
    std::optional<double> nearest_m, farthest_m;
};

[[nodiscard]] DepthRange depth_range(const SampleFileReader& file);
/// Of the finite depths, px.
[[nodiscard]] double largest_coc_px(const DepthRange& range, const FocusGeometry& geometry);

/// A set of levels. A sample uses the one whose depth is nearest to its own in the chosen spacing.
///
/// With K given: K equal steps from the nearest to the farthest finite z' and one level more for infinity
/// [potmesil1981]. Without: inverse spacing puts levels around the focus, so that what is in focus is
/// exactly sharp and equal CoCs before and behind it share a level: those of LevelTable. Linear spacing takes
/// as many levels as keep the CoC within half a pixel, but no more than `most_linear_levels`.
class DepthLevels {
  public:
    static constexpr int most_depths = 4096;
    static constexpr int most_linear_levels = 256;
    /// Radius at the depth in focus: not zero, so that it has an area, yet inside any pixel's quarter.
    static constexpr double smallest_radius_px = 1e-4;
    /// Beyond, a sample's share in any pixel is below 1e-10 and its distribution over the picture even.
    static constexpr double largest_radius_px = LevelTable::largest_diameter_px / 2;

    /// Throws Error(wrong_arguments) for `depths` outside 2..most_depths.
    DepthLevels(const FocusGeometry& geometry, const DepthRange& range, DepthSpacing spacing,
                std::optional<int> depths);

    /// The level for an inverse depth, 1/m: 0 is infinity; negative ones (images behind the lens) and others
    /// outside the range may have none where K was given or the spacing is linear.
    [[nodiscard]] std::optional<std::uint32_t> level_of(double inverse_depth_per_m) const {
        if (around_focus_) return table_->level_of(geometry_.coc_diameter_px(inverse_depth_per_m));
        return level_from_nearest(inverse_depth_per_m);
    }
    /// True where every inverse depth has a level, that of levels_of.
    [[nodiscard]] bool around_focus() const { return around_focus_; }
    /// level_of for many, where they are around the focus; `level` has as many places.
    void levels_of(std::span<const double> inverse_depth_per_m, std::uint32_t* level) const {
        table_->levels_of(geometry_, inverse_depth_per_m.data(), inverse_depth_per_m.size(), level);
    }
    /// Radii by level.
    [[nodiscard]] const std::vector<double>& radius_px() const { return radius_px_; }
    /// K, without the level for infinity; absent where the levels are those around the focus, of which a file
    /// uses as many as it has CoCs.
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
