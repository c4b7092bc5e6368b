// Synthetic images, and the difference of two images.
#pragma once

#include <cmath>
#include <random>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"
#include "pictures/srgb.h"

namespace postlens::test {

/// An image of one colour.
inline Image constant_picture(int width, int height, float r, float g, float b) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        image.rgb[i] = r;
        image.rgb[i + 1] = g;
        image.rgb[i + 2] = b;
    }
    return image;
}

/// A grey image.
inline Image constant_picture(int width, int height, float v) {
    return constant_picture(width, height, v, v, v);
}

/// An image of smooth waves with values between 0.2 and 0.8.
inline Image waves(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float* p = image.pixel(x, y);
            for (int c = 0; c < 3; ++c) {
                p[c] = 0.5F + 0.3F * std::sin(0.11F * static_cast<float>(x) + static_cast<float>(c)) *
                                  std::cos(0.07F * static_cast<float>(y));
            }
        }
    }
    return image;
}

/// The image with Gaussian noise of standard deviation `sigma` added to each value.
inline Image noisy(Image image, double sigma, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0, sigma);
    for (float& v : image.rgb) v = static_cast<float>(static_cast<double>(v) + noise(generator));
    return image;
}

/// Mean squared difference of sRGB values that are not clamped.
inline double encoded_mse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double d =
            static_cast<double>(srgb_from_linear(a.rgb[i])) - static_cast<double>(srgb_from_linear(b.rgb[i]));
        sum += d * d;
    }
    return sum / static_cast<double>(a.rgb.size());
}

inline double encoded_psnr_db(const Image& a, const Image& b) {
    return -10 * std::log10(encoded_mse(a, b));
}

/// A mask that selects all pixels.
inline PixelMask every_pixel(const Image& image) {
    return PixelMask(image.rgb.size() / 3, 1);
}

}  // namespace postlens::test
