// Traces a reference in a limited time. The viewer needs it for its map of error causes.
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
    /// Standard deviation of the noise of each pixel in sRGB values, estimated from the pixels around it.
    std::vector<float> noise;
};

/// Traces a reference for about 10 s, but with at least 32 and at most 1024 rays per pixel. `trace` must make
/// an image with the given number of rays per pixel, which is even.
[[nodiscard]] ErrorReference trace_error_reference(const std::function<HalvedImage(int spp)>& trace);

/// Excludes noise from the error of `image`. If a pixel of the image and the reference differ by at most
/// three standard deviations of the noise, that pixel of the reference is set to the image's colour. Throws
/// Error(invalid_input) if the sizes differ.
void take_out_noise(ErrorReference& reference, const Image& image);

}  // namespace postlens
