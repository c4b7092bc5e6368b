// Reference images by rays: their noise is not counted as an error, and uniform regions are not traced.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>

#include "pictures/srgb.h"
#include "tracer/render.h"

namespace postlens::test {

/// An image by rays, and two images by independent halves of these rays.
struct Reference {
    Image image;
    std::array<Image, 2> halves;
};

inline Reference reference(const Scene& scene, RenderSettings settings) {
    settings.halves = true;
    RenderResult r = render_picture(scene, settings);
    return {std::move(r.image), std::move(r.halves)};
}

/// The squared error of all colour values against the reference without its noise: the mean of
/// (image - half 0) * (image - half 1). The noise of the halves is independent, so it does not change the
/// expected value of this product. A result below a tenth of the reference's own squared noise could be
/// chance; that tenth is returned instead.
inline double squared_error(const Image& image, const Reference& r) {
    double error = 0, noise = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const auto v = static_cast<double>(image.rgb[i]), a = static_cast<double>(r.halves[0].rgb[i]),
                   b = static_cast<double>(r.halves[1].rgb[i]);
        error += (v - a) * (v - b);
        noise += (a - b) * (a - b) / 4;
    }
    return std::max(error, noise / 10) / static_cast<double>(image.rgb.size());
}

/// The peak signal-to-noise ratio of all colour values against the reference without its noise, dB.
inline double psnr(const Image& image, const Reference& r, double peak = 1) {
    return -10 * std::log10(squared_error(image, r) / peak / peak);
}

/// The image with sRGB values, clamped to 0..1, instead of linear ones.
inline Image encoded(Image image) {
    for (float& v : image.rgb) v = srgb_from_linear(v);
    return image;
}

/// `psnr` of the sRGB values, dB.
inline double encoded_psnr(const Image& image, const Reference& r) {
    return psnr(encoded(image), {.image = {}, .halves = {encoded(r.halves[0]), encoded(r.halves[1])}});
}

/// The image by rays of a scene in which a lens sees only uniform surfaces through pixels outside of `crop`.
/// Rays are traced in `crop` alone. The other pixels have the value of the nearest pixel of `crop`; the
/// pixels along each of its sides must be equal.
inline Image rendered_within(const Scene& scene, RenderSettings settings, const Crop& crop) {
    settings.crop = crop;
    Image image = render_picture(scene, settings).image;
    const int x_end = crop.x + crop.width, y_end = crop.y + crop.height;
    const auto expect_uniform = [&](bool inside, int x0, int y0, int x1, int y1) {
        if (!inside) return;
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                for (int c = 0; c < 3; ++c)
                    ASSERT_EQ(image.pixel(x, y)[c], image.pixel(x0, y0)[c])
                        << x << ',' << y << " is not uniform";
            }
        }
    };
    expect_uniform(crop.x > 0, crop.x, crop.y, crop.x, y_end - 1);
    expect_uniform(crop.y > 0, crop.x, crop.y, x_end - 1, crop.y);
    expect_uniform(x_end < image.width, x_end - 1, crop.y, x_end - 1, y_end - 1);
    expect_uniform(y_end < image.height, crop.x, y_end - 1, x_end - 1, y_end - 1);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (crop.contains(x, y)) continue;
            std::copy_n(image.pixel(std::clamp(x, crop.x, x_end - 1), std::clamp(y, crop.y, y_end - 1)), 3,
                        image.pixel(x, y));
        }
    }
    return image;
}

}  // namespace postlens::test
