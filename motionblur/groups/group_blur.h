// Motion blur of a group of moving objects that have the same motion path. The group's image is convolved
// with an image of this path. This is done for the whole group, or separately for slices of different depth.
#pragma once

#include "lens/shutter_curve.h"
#include "motionblur/groups/depth_slices.h"
#include "motionblur/groups/group_raster.h"

namespace postlens {

/// A pixel counts as empty if a blurred object covers at most this fraction of it. The blur is computed by
/// Fourier transforms, whose rounding errors can be of this size.
inline constexpr float least_coverage = 2e-6F;

/// Keeps references to the exposure and the curve.
class GroupBlur {
  public:
    /// `width` and `height` are the size of the frame in px.
    GroupBlur(int width, int height, int cells_per_px, const Exposure& exposure, const ShutterCurve& curve)
        : width_(width), height_(height), cells_per_px_(cells_per_px), exposure_(exposure), curve_(curve) {}

    /// Blurs all depths of a group of objects along one path.
    [[nodiscard]] GroupPicture whole(const Planes& i1, const MovingGroup& group) const;
    /// Blurs a group of moving objects in slices by depth, each along its own motion path. The blurred slices
    /// are added without testing which slice hides another, because all are parts of one opaque surface.
    [[nodiscard]] GroupPicture sliced(const DepthSlices& slices, const MovingGroup& group) const;

  private:
    [[nodiscard]] Planes convolved(const Planes& i1, const std::vector<PathPoint>& path,
                                   const std::vector<double>& values) const;
    [[nodiscard]] GroupPicture nothing_over(const DepthSlices& slices, const MovingGroup& group) const;

    int width_, height_, cells_per_px_;
    const Exposure& exposure_;
    const ShutterCurve& curve_;
};

}  // namespace postlens
