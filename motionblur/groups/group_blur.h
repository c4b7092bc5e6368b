// Motion blur of a moving group of objects. The raster of the group is convolved with the raster of its path,
// either as a whole or in depth slices.
#pragma once

#include "lens/shutter_curve.h"
#include "motionblur/groups/depth_slices.h"
#include "motionblur/groups/group_raster.h"

namespace postlens {

/// Coverage below this value is treated as 0, because it may be a rounding error of a Fourier transform.
inline constexpr float least_coverage = 2e-6F;

/// Keeps references to the exposure and the curve.
class GroupBlur {
  public:
    /// `width` and `height` are the size of the frame in px.
    GroupBlur(int width, int height, int cells_per_px, const Exposure& exposure, const ShutterCurve& curve)
        : width_(width), height_(height), cells_per_px_(cells_per_px), exposure_(exposure), curve_(curve) {}

    /// Moves the whole group along its path.
    [[nodiscard]] GroupPicture whole(const Planes& i1, const MovingGroup& group) const;
    /// Moves each depth slice of the group along its own path and returns the sum of the slices. The slices
    /// do not hide each other, because they are parts of one opaque surface.
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
