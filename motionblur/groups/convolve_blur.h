// Motion blur by convolution [potmesil1983]. The raster of every moving group is convolved with the raster of
// its path. The results and the static surfaces are composited in the order of depth.
#pragma once

#include <cstdint>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/groups/band_surfaces.h"
#include "motionblur/groups/moving_group.h"
#include "pictures/image.h"

namespace postlens {

/// The error where two groups cross. Each pixel is composited as if the coverage by the nearer group were
/// independent of the light of the farther group. That is wrong where both change during the exposure.
struct Crossing {
    std::size_t other = 0;  ///< the group with the largest `most_mse`
    /// Upper bound of the mean squared error over the pixels that the group touches, for light of up to 1.
    double most_mse = 0;
};

struct ConvolveBlur {
    Image image;                        ///< equal to `still` in pixels over which nothing moves
    std::vector<std::uint8_t> touched;  ///< 1: a group moves over the pixel, or was recorded in it
    std::vector<float> unknown;         ///< share of a pixel's light that comes from an unrecorded background
    std::vector<Crossing> crossings;    ///< one per group
};

/// Blurs groups of objects. The objects of a group share a path. `still`: pinhole image of the records.
/// `groups`: nearest first. `across_per_px`: size of a pixel on the film (sample_surfaces.h). The raster of a
/// group and the raster of its path have cells of the same size (cells_for). Quadtree leaves are drawn into
/// the group's raster without resampling.
///
/// A pixel is composited front to back: the static surfaces in front of the nearest group, that group, the
/// static surfaces behind it, and so on. The weight of a static surface is its coverage among the samples
/// whose records reach to that depth.
[[nodiscard]] ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                                         const std::vector<MovingGroup>& groups, const Exposure& exposure,
                                         const ShutterCurve& curve, double across_per_px);

}  // namespace postlens
