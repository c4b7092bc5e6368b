// A ray-traced reference for the viewer's map of error causes, made in a limited time.
#pragma once

#include <functional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// An image traced with rays, as the mean of two independent halves.
struct HalvedImage {
    Image image, first_half, second_half;
    double seconds = 0;  ///< time that tracing took, s
};

struct ErrorReference {
    Image image;
    int spp = 0;
    /// Standard deviation of the noise of each pixel, sRGB values, averaged over the pixels around it.
    std::vector<float> noise;
};

/// Traces a reference for about 10 s, but with at least 32 and at most 1024 rays per pixel. The caller's
/// `trace` must make an image with the given even number of rays per pixel.
[[nodiscard]] ErrorReference trace_error_reference(const std::function<HalvedImage(int spp)>& trace);

/// Sets the pixels of the reference to those of the image where both differ by no more than three standard
/// deviations of the reference's noise, so that noise does not count as an error of the image. Throws
/// Error(invalid_input) if the sizes differ.
void take_out_noise(ErrorReference& reference, const Image& image);

}  // namespace postlens
