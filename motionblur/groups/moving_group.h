// Finds groups of moving objects that share a path on the raster. Objects without parallax share a path if
// their centres move alike. Objects with parallax share a path if their points at equal depths move alike.
#pragma once

#include <vector>

#include "motionblur/motion_kinds.h"
#include "motionblur/paths/screen_path.h"

namespace postlens {

struct MovingGroup {
    std::vector<std::uint32_t> ids;  ///< sorted
    IdExtent extent;
    double inverse_z = 0;  ///< mean inverse depth of the group's records, 1/m; groups are sorted by it
    /// Inverse depth, in 1/m, of the points that move along `path`. With parallax, the displacement of other
    /// points is proportional to their inverse depth. Without parallax, all points move along `path`.
    double path_inverse_z = 0;
    bool has_parallax = false;
    /// The group's displacement from its recorded position, in px, at instants of the exposure. It changes
    /// linearly in time between these points.
    std::vector<PathPoint> path;
    std::size_t points = 0;        ///< number of the path's points before it was fitted
    std::size_t fitted_knots = 0;  ///< number of knots of the fitted path; 0 if the path is not fitted
    double fit_error_px = 0;
};

/// Returns the largest displacement of the group from its recorded position, in px.
[[nodiscard]] double longest_way_px(const MovingGroup& group);
/// Returns the largest difference, in px, between the displacements of the group's nearest point and its
/// farthest point. It is 0 without parallax.
[[nodiscard]] double parallax_px(const MovingGroup& group);

/// Groups the moving objects whose displacements agree within 0.02 px at all times. Objects with parallax
/// form a group if they overlap in depth and their displacements, scaled to the same depth, agree. Groups are
/// sorted from near to far.
///
/// If `fit_px` is given, each path is replaced by a spline of few knots that stays within `fit_px` of the
/// path (`fit_path`). Throws Error(wrong_arguments) for an object that passes the camera, because it has no
/// path.
[[nodiscard]] std::vector<MovingGroup> find_groups(const FrameMotion& motion,
                                                   const std::vector<IdMotion>& ids, const IdExtents& extents,
                                                   double recorded_s, const Exposure& exposure,
                                                   const std::optional<double>& fit_px);

}  // namespace postlens
