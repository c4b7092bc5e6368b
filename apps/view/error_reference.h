// Traces a reference image in a limited time. The viewer compares its image with this reference to find the
// causes of errors.
#pragma once

#include <functional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// An image made by tracing rays. It is the mean of two independent halves.
struct HalvedImage {
    Image image, first_half, second_half;
    double seconds = 0;  ///< time that tracing took, s
};

struct ErrorReference {
    Image image;
    int spp = 0;
    /// Standard deviation of the noise of each pixel, in sRGB values, averaged over the neighbouring pixels.
    std::vector<float> noise;
};

/// Traces a reference for about 10 s, but with at least 32 and at most 1024 rays per pixel. `trace` must make
/// an image with the given number of rays per pixel, which is even.
[[nodiscard]] ErrorReference trace_error_reference(const std::function<HalvedImage(int spp)>& trace);

/// Prevents noise of the reference from counting as an error of `image`. Where the two differ by at most
/// three standard deviations of the noise, the image's colour is copied to the reference. Throws
/// Error(invalid_input) if the sizes differ.
void take_out_noise(ErrorReference& reference, const Image& image);

}  // namespace postlens
