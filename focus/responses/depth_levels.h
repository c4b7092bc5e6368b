// The K impulse responses of [potmesil1981]: the depths that have one, and the choice of the response for a
// sample.
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
    ray_differentials,  ///< W of each node; reflections have the depth of their virtual image
    path,               ///< z' of each node, the path length of [potmesil1981]
    first_hit,          ///< z' of the primary node for all nodes of its sample (as without shading trees)
};

/// The range of finite z' in a file; none if nothing was hit.
struct DepthRange {
    std::optional<double> nearest_m, farthest_m;
};

[[nodiscard]] DepthRange depth_range(const SampleFileReader& file);
/// Largest CoC diameter in the range, px.
[[nodiscard]] double largest_coc_px(const DepthRange& range, const FocusGeometry& geometry);

/// A set of depth levels. A sample uses the impulse response of the level nearest to its depth; distances are
/// measured in the chosen spacing.
///
/// If the number of levels K is given, there are K equal steps from the nearest to the farthest finite z',
/// and one more level for infinity [potmesil1981]. Without K, inverse spacing uses the levels of LevelTable,
/// which lie around the focus: samples in focus are exactly sharp, and equal CoCs in front of and behind the
/// focus share a level. Without K, linear spacing has enough levels to quantise the CoC by half a pixel, but
/// at most `most_linear_levels`.
class DepthLevels {
  public:
    static constexpr int most_depths = 4096;
    static constexpr int most_linear_levels = 256;
    /// Radius, px, at the depth in focus: above 0 so that the disc has an area, and small enough that the
    /// disc lies within one pixel.
    static constexpr double smallest_radius_px = 1e-4;
    /// Largest radius, px. A sample with a larger radius would add less than 1e-10 to any pixel, uniformly
    /// over the image.
    static constexpr double largest_radius_px = LevelTable::largest_diameter_px / 2;

    /// Throws Error(wrong_arguments) for `depths` outside 2..most_depths.
    DepthLevels(const FocusGeometry& geometry, const DepthRange& range, DepthSpacing spacing,
                std::optional<int> depths);

    /// The level for an inverse depth, 1/m; 0 is infinity. If the number of levels was given or the spacing
    /// is linear, there may be no level for inverse depths outside the range, for example for negative ones
    /// (images behind the lens).
    [[nodiscard]] std::optional<std::uint32_t> level_of(double inverse_depth_per_m) const {
        if (around_focus_) return table_->level_of(geometry_.coc_diameter_px(inverse_depth_per_m));
        return level_from_nearest(inverse_depth_per_m);
    }
    /// Whether the levels are those of LevelTable. If so, every inverse depth has a level, and levels_of may
    /// be called.
    [[nodiscard]] bool around_focus() const { return around_focus_; }
    /// Computes level_of for several inverse depths. `level` must have the same number of elements. Requires
    /// around_focus().
    void levels_of(std::span<const double> inverse_depth_per_m, std::uint32_t* level) const {
        table_->levels_of(geometry_, inverse_depth_per_m.data(), inverse_depth_per_m.size(), level);
    }
    /// Radius per level, px.
    [[nodiscard]] const std::vector<double>& radius_px() const { return radius_px_; }
    /// The number of levels K, without the level for infinity. Absent if the levels are those of LevelTable.
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
