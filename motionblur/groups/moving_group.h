// Groups of objects that share a path: either the centres of the objects move alike on the raster, or points
// of the objects at equal depths move alike.
#pragma once

#include <vector>

#include "motionblur/motion_kinds.h"
#include "motionblur/paths/screen_path.h"

namespace postlens {

struct MovingGroup {
    std::vector<std::uint32_t> ids;  ///< sorted
    IdExtent extent;
    double inverse_z = 0;  ///< mean inverse depth of the group's records, 1/m; groups are sorted by it
    /// Inverse depth, 1/m, of the points whose displacement is `path`. With parallax, the displacement of any
    /// other point is `path` times its inverse depth / path_inverse_z. Without parallax, it is `path` for all
    /// points.
    double path_inverse_z = 0;
    bool has_parallax = false;
    /// Displacement from the recorded position, px, between the opening and the closing of the shutter,
    /// linear in time between the points.
    std::vector<PathPoint> path;
    std::size_t points = 0;        ///< number of the path's points before it was fitted
    std::size_t fitted_knots = 0;  ///< number of knots of the fitted path; 0: not fitted
    double fit_error_px = 0;
};

/// Largest displacement of the group from its recorded position, px.
[[nodiscard]] double longest_way_px(const MovingGroup& group);
/// Largest difference, px, between the displacements of the group's nearest point and its farthest point. 0
/// without parallax.
[[nodiscard]] double parallax_px(const MovingGroup& group);

/// Groups all moving objects that share a path. The nearest group comes first. Objects share a group if their
/// displacements agree within 0.02 px at all times. Objects with parallax share a group if they overlap in
/// depth and their displacements agree at equal depths. `fit_px`: tolerance within which each path is
/// replaced by a spline of few knots (`fit_path`); if absent, paths are not replaced. Throws
/// Error(wrong_arguments) for an object that passes the camera, because it has no path.
[[nodiscard]] std::vector<MovingGroup> find_groups(const FrameMotion& motion,
                                                   const std::vector<IdMotion>& ids, const IdExtents& extents,
                                                   double recorded_s, const Exposure& exposure,
                                                   const std::optional<double>& fit_px);

}  // namespace postlens
