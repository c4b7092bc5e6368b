// Makes a reference image by tracing rays for a limited time. The viewer compares its own image with this
// reference, to find where its image is wrong and what causes the error.
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
    /// Standard deviation of each pixel's noise, in sRGB values from 0 to 1, averaged over neighbouring
    /// pixels.
    std::vector<float> noise;
};

/// Traces a reference for about 10 s, but with at least 32 and at most 1024 rays per pixel. The number that
/// `trace` receives is even, because half of the rays go to each of two images. Their difference shows the
/// noise.
[[nodiscard]] ErrorReference trace_error_reference(const std::function<HalvedImage(int spp)>& trace);

/// Prevents the noise of the reference image from counting as an error of `image`. Where `image` differs from
/// the reference by at most three standard deviations of the noise, the reference gets the colour of `image`,
/// so the error becomes 0. Throws Error(invalid_input) if the sizes differ.
void take_out_noise(ErrorReference& reference, const Image& image);

}  // namespace postlens
