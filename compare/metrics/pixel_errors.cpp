#include "compare/metrics/pixel_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "compare/metrics/square.h"
#include "core/threads.h"

namespace postlens {
namespace {

// Relative squared error of one pixel, averaged over its channels.
double relative_squared_error(const float* a, const float* b) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        const auto wanted = static_cast<double>(b[c]);
        sum += square(static_cast<double>(a[c]) - wanted) / (square(wanted) + relmse_epsilon);
    }
    return sum / 3;
}

// Returns the mean squared difference between the images over all channels of the pixels that `mask` selects.
// `pixels` is their number.
double mean_squared(const Image& a, const Image& b, const PixelMask& mask, double pixels) {
    const auto width = static_cast<std::size_t>(a.width);
    const double sum = sum_of_rows(a.height, [&](std::size_t y) {
        double total = 0;
        for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
            if (mask[i] == 0) continue;
            for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
                total += square(static_cast<double>(a.rgb[c]) - static_cast<double>(b.rgb[c]));
        }
        return total;
    });
    return sum / (3 * pixels);
}

// Returns the mean of the values without the `dropped` greatest ones. They are added in the given order.
double trimmed_mean(const std::vector<double>& values, std::size_t dropped) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const std::size_t kept = values.size() - dropped;
    std::vector<double> order = values;
    const auto greatest_kept = order.begin() + static_cast<std::ptrdiff_t>(kept - 1);
    std::nth_element(order.begin(), greatest_kept, order.end());
    const double limit = *greatest_kept;
    double sum = 0;
    std::size_t below = 0;
    for (const double v : values) {
        if (v < limit) {
            sum += v;
            ++below;
        }
    }
    return (sum + static_cast<double>(kept - below) * limit) / static_cast<double>(kept);
}

}  // namespace

double psnr_from_mse(double mse) {
    return -10 * std::log10(mse);
}

PixelErrors pixel_errors(const Picture& image, const Picture& reference, const PixelMask& mask) {
    PixelErrors out;
    out.pixels = count(mask);
    const auto pixels = static_cast<double>(out.pixels);
    out.rmse = std::sqrt(mean_squared(image.linear, reference.linear, mask, pixels));
    out.psnr_db = psnr_from_mse(mean_squared(image.encoded, reference.encoded, mask, pixels));

    std::vector<double> relative(mask.size());
    const auto width = static_cast<std::size_t>(image.linear.width);
    out.relmse = sum_of_rows(image.linear.height,
                             [&](std::size_t y) {
                                 double total = 0;
                                 for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
                                     if (mask[i] == 0) continue;
                                     relative[i] =
                                         relative_squared_error(image.linear.rgb.data() + 3 * i,
                                                                reference.linear.rgb.data() + 3 * i);
                                     total += relative[i];
                                 }
                                 return total;
                             }) /
                 pixels;
    std::size_t used = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] != 0) relative[used++] = relative[i];
    }
    relative.resize(used);
    out.relmse_trimmed = trimmed_mean(relative, used / 1000);
    return out;
}

}  // namespace postlens
