// Motion blur of a group of moving objects: its image is convolved with that of its motion path, as a whole
// or in depth slices.
#pragma once

#include "lens/shutter_curve.h"
#include "motionblur/groups/depth_slices.h"
#include "motionblur/groups/group_raster.h"

namespace postlens {

/// A coverage up to this value counts as 0, because it may be a rounding error of a Fourier transform.
inline constexpr float least_coverage = 2e-6F;

/// Keeps references to the exposure and the curve.
class GroupBlur {
  public:
    /// `width` and `height` are the size of the frame in px.
    GroupBlur(int width, int height, int cells_per_px, const Exposure& exposure, const ShutterCurve& curve)
        : width_(width), height_(height), cells_per_px_(cells_per_px), exposure_(exposure), curve_(curve) {}

    /// Blurs all depths of a group of objects along one path.
    [[nodiscard]] GroupPicture whole(const Planes& i1, const MovingGroup& group) const;
    /// Blurs each depth slice of an object along its own path, and adds the slices. They do not hide each
    /// other, because they belong to one opaque surface.
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
