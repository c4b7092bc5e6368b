// A plane of coloured tiles, on which no surface hides another, and statistics of its images.
#pragma once

#include <cmath>
#include <random>

#include "pictures/image.h"
#include "tests/support/scene_builder.h"

namespace postlens::test {

/// 16 x 12 square tiles of side `tile_m` at depth `depth_m`. About 6 % of them are lights with a radiance of
/// up to 12.
inline Scene mosaic(double depth_m, double tile_m) {
    SceneBuilder b;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> even(0, 1);
    for (int y = -6; y < 6; ++y) {
        for (int x = -8; x < 8; ++x) {
            const bool light = even(random) < 0.06;
            const glm::dvec3 colour(even(random), even(random), even(random));
            b.add(Rectangle{{x * tile_m, y * tile_m, -depth_m}, {tile_m, 0, 0}, {0, tile_m, 0}},
                  glowing((light ? 12.0 : 0.6) * colour));
        }
    }
    return b.scene;
}

/// The peak signal-to-noise ratio of all colour values, dB.
inline double psnr(const Image& a, const Image& b, double peak) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double d = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
        sum += d * d;
    }
    return -10 * std::log10(sum / static_cast<double>(a.rgb.size()) / peak / peak);
}

/// The mean of all colour values.
inline double mean(const Image& image) {
    double sum = 0;
    for (const float v : image.rgb) sum += static_cast<double>(v);
    return sum / static_cast<double>(image.rgb.size());
}

}  // namespace postlens::test
