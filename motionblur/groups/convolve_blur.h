// Motion blur by convolution [potmesil1983]. Each moving group's raster is convolved with its path, and
// composited in order of depth.
#pragma once

#include <cstdint>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/groups/band_surfaces.h"
#include "motionblur/groups/moving_group.h"
#include "pictures/image.h"

namespace postlens {

/// The error where two groups of moving objects pass over the same pixels. A pixel is composited from the
/// mean coverage and the mean light of each group during the exposure. This is wrong if the nearer group's
/// coverage and the farther group's light are correlated in time.
struct Crossing {
    std::size_t other = 0;  ///< index of the crossing group with the largest error
    /// Upper bound of the mean squared error over the pixels that this moving group passes, for radiances up
    /// to 1.
    double most_mse = 0;
};

struct ConvolveBlur {
    Image image;                        ///< equal to `still` in pixels over which nothing moves
    std::vector<std::uint8_t> touched;  ///< 1 if a moving object passes over the pixel or was recorded in it
    std::vector<float> unknown;         ///< fraction of a pixel's light from background that is not recorded
    std::vector<Crossing> crossings;    ///< one per group of moving objects
};

/// Blurs groups of moving objects by convolution. Composites them with the static surfaces from front to
/// back.
/// - `still`: pinhole image
/// - `groups`: sorted from near to far
/// - `across_per_px`: width of a pixel in the scene, in m; for a perspective camera, at a depth of 1 m
[[nodiscard]] ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                                         const std::vector<MovingGroup>& groups, const Exposure& exposure,
                                         const ShutterCurve& curve, double across_per_px);

}  // namespace postlens
