// Motion blur by convolution [potmesil1983]. The image of each moving group is convolved with the image of
// its path. The results are composited in order of depth.
#pragma once

#include <cstdint>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/groups/band_surfaces.h"
#include "motionblur/groups/moving_group.h"
#include "pictures/image.h"

namespace postlens {

/// The error of compositing two groups of moving objects that pass over the same pixels. Each group is
/// composited with its mean during the exposure. This is wrong, for example, if the nearer group hides a
/// pixel just while the farther group is bright there.
struct Crossing {
    std::size_t other = 0;  ///< index of the crossing group with the largest error
    /// Upper bound of the error that compositing causes where this group of moving objects and the group
    /// `other` overlap. It is a mean of squared errors over all pixels over which this group passes, and
    /// holds for radiances up to 1.
    double most_mse = 0;
};

struct ConvolveBlur {
    Image image;                        ///< equal to `still` in pixels over which nothing moves
    std::vector<std::uint8_t> touched;  ///< 1 if a moving object passes over the pixel or was recorded in it
    std::vector<float> unknown;         ///< fraction of a pixel's light from background that is not recorded
    std::vector<Crossing> crossings;    ///< one per group of moving objects
};

/// Blurs groups of moving objects, each by convolution with its motion path. Then composites them with the
/// static surfaces of `still`, the pinhole image.
/// - `groups`: sorted from near to far
/// - `across_per_px`: width of a pixel in the scene, in m; for a perspective camera, at a depth of 1 m
[[nodiscard]] ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                                         const std::vector<MovingGroup>& groups, const Exposure& exposure,
                                         const ShutterCurve& curve, double across_per_px);

}  // namespace postlens
