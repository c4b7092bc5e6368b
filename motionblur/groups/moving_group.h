// Finds groups of moving objects that can be blurred together, because they have the same motion path in the
// image. With parallax, near points move farther in the image than distant points. In this case, two objects
// form a group if their points at equal depth move alike.
#pragma once

#include <vector>

#include "motionblur/motion_kinds.h"
#include "motionblur/paths/screen_path.h"

namespace postlens {

struct MovingGroup {
    std::vector<std::uint32_t> ids;  ///< sorted
    IdExtent extent;
    double inverse_z = 0;  ///< mean inverse depth of the recorded samples, 1/m; groups are sorted by it
    /// Inverse depth, in 1/m, of the points whose displacements `path` contains. With parallax, nearer points
    /// move farther than these.
    double path_inverse_z = 0;
    bool has_parallax = false;
    /// Motion path of the group in the image. Each point holds the displacement from the recorded position at
    /// one instant, in px. Between neighbouring points, the displacement is linear in time.
    std::vector<PathPoint> path;
    std::size_t points = 0;        ///< number of the path's points before it was fitted
    std::size_t fitted_knots = 0;  ///< number of knots of the fitted path; 0 if the path is not fitted
    double fit_error_px = 0;
};

/// Returns the largest displacement along the motion path of a group of objects, from their recorded
/// position, in px.
[[nodiscard]] double longest_way_px(const MovingGroup& group);
/// Returns how much farther the nearest point of a moving group is displaced in the image than its farthest
/// point, in px. This is measured where the displacement is largest. The result is 0 if the group has no
/// parallax.
[[nodiscard]] double parallax_px(const MovingGroup& group);

/// Groups the moving objects whose displacements in the image agree. With parallax, displacements at equal
/// depth must agree. Returns the groups from near to far.
///
/// If `fit_px` is given, motion paths are replaced by splines whose error is at most this number of px.
/// Throws Error(wrong_arguments) for an object that moves behind the camera.
[[nodiscard]] std::vector<MovingGroup> find_groups(const FrameMotion& motion,
                                                   const std::vector<IdMotion>& ids, const IdExtents& extents,
                                                   double recorded_s, const Exposure& exposure,
                                                   const std::optional<double>& fit_px);

}  // namespace postlens
