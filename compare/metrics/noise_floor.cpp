#include "compare/metrics/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "compare/metrics/square.h"
#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr int greatest_block_px = 16;
constexpr std::size_t wanted_blocks = 64;

// Sums over a block of pixels, from which the error of an image is estimated by two noisy references. A is
// the image's difference from the first reference in one channel of a pixel, and B its difference from the
// second.
struct Sums {
    // The noise of the references is independent, so the mean of A B is the image's mean squared error
    // without noise.
    double product = 0;     // A B
    double preference = 0;  // A^2 - B^2
    double noise = 0;       // (A - B)^2
    void add(double a, double b, double weight) {
        product += weight * a * b;
        preference += weight * (a * a - b * b);
        noise += weight * (a - b) * (a - b);
    }
};

struct BlockSums {
    Sums encoded, linear, relative;
    double squared_bias = 0;
    std::size_t pixels = 0;
};

// Estimates the bias b of sRGB-encoded values that is caused by noise, in proportion to its variance. The
// mean of the encodings f1 and f2 of two noisy values r1 and r2 has the bias b. The encoding of their mean
// has only half of it, because averaging halves the variance. So b is twice the difference.
double encoding_bias(float r1, float r2, float f1, float f2) {
    return 2 * (0.5 * (static_cast<double>(f1) + static_cast<double>(f2)) -
                static_cast<double>(srgb_from_linear(0.5F * (r1 + r2))));
}

void add_value(const Picture& image, const Picture& r1, const Picture& r2, std::size_t i, BlockSums& to) {
    const auto value = [i](const Image& picture) { return static_cast<double>(picture.rgb[i]); };
    const double a = value(image.linear) - value(r1.linear), b = value(image.linear) - value(r2.linear);
    to.linear.add(a, b, 1);
    const double mean = 0.5 * (value(r1.linear) + value(r2.linear));
    to.relative.add(a, b, 1 / (mean * mean + relmse_epsilon));
    to.encoded.add(value(image.encoded) - value(r1.encoded), value(image.encoded) - value(r2.encoded), 1);
    if (r1.linear.rgb[i] != r2.linear.rgb[i]) {
        to.squared_bias +=
            square(encoding_bias(r1.linear.rgb[i], r2.linear.rgb[i], r1.encoded.rgb[i], r2.encoded.rgb[i]));
    }
}

std::size_t counted_blocks(const std::vector<BlockSums>& blocks) {
    return static_cast<std::size_t>(
        std::count_if(blocks.begin(), blocks.end(), [](const BlockSums& b) { return b.pixels > 0; }));
}

std::vector<BlockSums> sum_blocks(const Picture& image, const Picture& r1, const Picture& r2,
                                  const PixelMask& mask, int side_px) {
    const int width = image.linear.width, height = image.linear.height;
    const int columns = (width + side_px - 1) / side_px, rows = (height + side_px - 1) / side_px;
    std::vector<BlockSums> blocks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    parallel_for(static_cast<std::size_t>(rows), [&](std::size_t block_row) {
        const int y0 = static_cast<int>(block_row) * side_px;
        for (int y = y0; y < std::min(y0 + side_px, height); ++y) {
            for (int x = 0; x < width; ++x) {
                const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                          static_cast<std::size_t>(x);
                if (mask[pixel] == 0) continue;
                BlockSums& block = blocks[block_row * static_cast<std::size_t>(columns) +
                                          static_cast<std::size_t>(x / side_px)];
                ++block.pixels;
                for (std::size_t c = 0; c < 3; ++c) add_value(image, r1, r2, 3 * pixel + c, block);
            }
        }
    });
    return blocks;
}

NoisyError error_of(const std::vector<BlockSums>& blocks, Sums BlockSums::*which, double values) {
    double product = 0, variance = 0;
    for (const BlockSums& b : blocks) {
        product += (b.*which).product;
        variance += square((b.*which).preference) / 4;
    }
    return {.mse = product / values, .standard_error = std::sqrt(variance) / values};
}

// Returns the mean squared error of a noisy reference image due to its noise. It is half the mean squared
// difference of two references whose noise is independent.
double noise_of(const std::vector<BlockSums>& blocks, Sums BlockSums::*which, double values) {
    double noise = 0;
    for (const BlockSums& b : blocks) noise += (b.*which).noise;
    return noise / (2 * values);
}

}  // namespace

double NoisyError::least_rms() const {
    return std::max(0.0, std::sqrt(std::max(0.0, mse - 2 * standard_error)) - bias_rms);
}

double NoisyError::greatest_rms() const {
    return std::sqrt(std::max(0.0, mse) + 2 * standard_error) + bias_rms;
}

NoiseFloor noise_floor(const Picture& image, const Picture& reference, const Picture& second_reference,
                       const PixelMask& mask) {
    int side_px = greatest_block_px;
    std::vector<BlockSums> blocks = sum_blocks(image, reference, second_reference, mask, side_px);
    while (side_px > 1 && counted_blocks(blocks) < wanted_blocks) {
        side_px /= 2;
        blocks = sum_blocks(image, reference, second_reference, mask, side_px);
    }
    const auto values = static_cast<double>(3 * count(mask));
    NoiseFloor out;
    out.reference_mse = noise_of(blocks, &BlockSums::encoded, values);
    out.reference_rmse = std::sqrt(noise_of(blocks, &BlockSums::linear, values));
    out.reference_relmse = noise_of(blocks, &BlockSums::relative, values);
    out.encoded = error_of(blocks, &BlockSums::encoded, values);
    out.linear = error_of(blocks, &BlockSums::linear, values);
    out.relative = error_of(blocks, &BlockSums::relative, values);
    double squared_bias = 0, preference = 0, variance = 0;
    for (const BlockSums& b : blocks) {
        squared_bias += b.squared_bias;
        preference += b.linear.preference;
        variance += square(b.linear.preference);
    }
    out.encoded.bias_rms = std::sqrt(squared_bias / values);
    out.preference = variance > 0 ? preference / std::sqrt(variance) : 0;
    return out;
}

}  // namespace postlens
