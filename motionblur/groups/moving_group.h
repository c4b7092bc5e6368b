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
    /// Inverse depth, in 1/m, for which `path` states the displacements. With parallax, nearer points of the
    /// group are displaced more than `path` states, in proportion to their inverse depth.
    double path_inverse_z = 0;
    bool has_parallax = false;
    /// Motion path of this group of objects in the image. Each point states the displacement, in px, at one
    /// instant: the difference from the position at which the group is recorded. Between neighbouring points,
    /// the displacement is linear in time.
    std::vector<PathPoint> path;
    std::size_t points = 0;        ///< number of the path's points before it was fitted
    std::size_t fitted_knots = 0;  ///< number of knots of the fitted path; 0 if the path is not fitted
    double fit_error_px = 0;
};

/// Returns the largest displacement along the motion path of a group of objects, from their recorded
/// position, in px.
[[nodiscard]] double longest_way_px(const MovingGroup& group);
/// Returns the parallax of a group of moving objects: the displacement of the group's nearest point in the
/// image minus that of its farthest point, in px. It is measured at the instant of the largest displacement.
/// The result is 0 if has_parallax is false.
[[nodiscard]] double parallax_px(const MovingGroup& group);

/// Divides the moving objects into groups with equal displacements in the image, and returns the groups,
/// sorted from near to far. For objects with parallax, only displacements of points at the same depth need to
/// be equal.
///
/// If `fit_px` is given, splines replace the motion paths, with an error of at most this number of px. Throws
/// Error(wrong_arguments) for an object that moves behind the camera.
[[nodiscard]] std::vector<MovingGroup> find_groups(const FrameMotion& motion,
                                                   const std::vector<IdMotion>& ids, const IdExtents& extents,
                                                   double recorded_s, const Exposure& exposure,
                                                   const std::optional<double>& fit_px);

}  // namespace postlens
