// A moving group over the exposure: i1 * i2, as a whole or slice by slice.
#pragma once

#include "lens/shutter_curve.h"
#include "motionblur/depth_slices.h"
#include "motionblur/group_raster.h"

namespace postlens {

/// Coverage below this is the rounding of a Fourier transform.
inline constexpr float least_coverage = 2e-6F;

/// Keeps references to the exposure and the curve.
class GroupBlur {
  public:
    /// For a frame of width x height px.
    GroupBlur(int width, int height, int cells_per_px, const Exposure& exposure, const ShutterCurve& curve)
        : width_(width), height_(height), cells_per_px_(cells_per_px), exposure_(exposure), curve_(curve) {}

    /// All of it on the group's path.
    [[nodiscard]] GroupPicture whole(const Planes& i1, const MovingGroup& group);
    /// Each slice on its own. Slices are parts of one opaque surface: they add up.
    [[nodiscard]] GroupPicture sliced(const DepthSlices& slices, const MovingGroup& group);

    /// Convolutions so far.
    [[nodiscard]] int direct() const { return direct_; }
    [[nodiscard]] int fft() const { return fft_; }

  private:
    [[nodiscard]] Planes convolved(const Planes& i1, const std::vector<PathPoint>& path,
                                   const std::vector<double>& values);
    [[nodiscard]] GroupPicture nothing_over(const DepthSlices& slices, const MovingGroup& group) const;

    int width_, height_, cells_per_px_;
    const Exposure& exposure_;
    const ShutterCurve& curve_;
    int direct_ = 0, fft_ = 0;
};

}  // namespace postlens
