// Motion blur as in 1983: every moving group's raster convolved with the raster of its path, composited in
// the order of depth over what stands still [potmesil1983].
#pragma once

#include <cstdint>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/band_surfaces.h"
#include "motionblur/moving_group.h"
#include "records/image.h"

namespace postlens {

struct ConvolveBlur {
    Image image;                        ///< the still picture where nothing moved
    std::vector<std::uint8_t> touched;  ///< 1: something moves over the pixel, or was recorded there
    std::vector<float> unknown;         ///< share of the light of which no surface behind is known
    int direct_groups = 0, fft_groups = 0;
};

/// `still`: the pinhole picture of the records. `groups`: the nearest first.
/// i1 has cells of 1/2 px or smaller and takes the leaves of the quadtree as they are; i2 the same cells.
/// A pixel is then, front to back: what stands still before the nearest group, that group, what stands still
/// behind it, and so on, each by the coverage of what is known there.
[[nodiscard]] ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                                         const std::vector<MovingGroup>& groups, const Exposure& exposure,
                                         const ShutterCurve& curve, double across_per_px);

}  // namespace postlens
