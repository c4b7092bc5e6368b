// What shares a path: ids whose middles move alike on the raster, or whose points do at equal depths.
#pragma once

#include <vector>

#include "motionblur/motion_kinds.h"
#include "motionblur/screen_path.h"

namespace postlens {

struct MovingGroup {
    std::vector<std::uint32_t> ids;  ///< sorted
    IdExtent extent;
    double inverse_z = 0;  ///< mean of its records, 1/m: its place in the order of depth
    /// Its points move by `path`, whatever their depths, or (parallax) times their inverse depth over this
    /// one, 1/m.
    double path_inverse_z = 0;
    bool has_parallax = false;
    /// Displacement from where it was recorded, px, linear in time between points; from open to close.
    std::vector<PathPoint> path;
    std::size_t points = 0;        ///< of the path before it was fitted
    std::size_t fitted_knots = 0;  ///< 0: not fitted
    double fit_error_px = 0;
};

/// The farthest that the path takes it from where it was recorded, px.
[[nodiscard]] double longest_way_px(const MovingGroup& group);
/// How far the path of its nearest point and that of its farthest come apart, px; 0 without parallax.
[[nodiscard]] double parallax_px(const MovingGroup& group);

/// The groups of all ids that do not stand still, the nearest first. Ids whose displacements agree within
/// 0.02 px at all times share a group; with parallax, ids that agree at equal depths and overlap in depth.
/// `fit_px`: replaces each path by a spline of few knots within so much.
/// Throws Error(wrong_arguments) for an id that passes the camera: it has no path.
[[nodiscard]] std::vector<MovingGroup> find_groups(const FrameMotion& motion,
                                                   const std::vector<IdMotion>& ids, const IdExtents& extents,
                                                   double recorded_s, const Exposure& exposure,
                                                   const std::optional<double>& fit_px);

}  // namespace postlens
