#include "compare/metrics/pixel_mask.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

// Minimum rows per task. Scheduling a task takes longer than computing one short row.
constexpr std::size_t grain_rows = 8;

}  // namespace

PixelMask finite_pixels(const Image& image) {
    PixelMask mask(image.rgb.size() / 3);
    const auto width = static_cast<std::size_t>(image.width);
    parallel_for(
        static_cast<std::size_t>(image.height),
        [&](std::size_t y) {
            for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
                const float* p = image.rgb.data() + 3 * i;
                mask[i] = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) ? 1 : 0;
            }
        },
        grain_rows);
    return mask;
}

PixelMask both(const PixelMask& a, const PixelMask& b) {
    PixelMask out(a.size());
    std::transform(a.begin(), a.end(), b.begin(), out.begin(),
                   [](std::uint8_t x, std::uint8_t y) { return static_cast<std::uint8_t>(x & y); });
    return out;
}

std::size_t count(const PixelMask& mask) {
    return std::accumulate(mask.begin(), mask.end(), std::size_t{0});
}

Image encoded_srgb(const Image& image) {
    Image out(image.width, image.height);
    const std::size_t row = static_cast<std::size_t>(image.width) * 3;
    parallel_for(
        static_cast<std::size_t>(image.height),
        [&](std::size_t y) {
            std::transform(image.rgb.data() + y * row, image.rgb.data() + (y + 1) * row,
                           out.rgb.data() + y * row, srgb_from_linear);
        },
        grain_rows);
    return out;
}

PixelMask affected_pixels(const Image& pinhole_encoded, const Image& reference_encoded,
                          const PixelMask& counted) {
    PixelMask mask(counted.size());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const float* p = pinhole_encoded.rgb.data() + 3 * i;
        const float* q = reference_encoded.rgb.data() + 3 * i;
        const float difference =
            std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
        mask[i] = counted[i] != 0 && difference > 1.0F / 255 ? 1 : 0;
    }
    return mask;
}

double sum_of_rows(int rows, const std::function<double(std::size_t y)>& row) {
    std::vector<double> sums(static_cast<std::size_t>(rows));
    parallel_for(
        sums.size(), [&](std::size_t y) { sums[y] = row(y); }, grain_rows);
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double mean_over(const std::vector<float>& map, int width, const PixelMask& mask) {
    const auto row = static_cast<std::size_t>(width);
    const int rows = static_cast<int>(map.size() / row);
    const auto sum = [&](const auto& value) {
        return sum_of_rows(rows, [&](std::size_t y) {
            double total = 0;
            for (std::size_t i = y * row; i < (y + 1) * row; ++i) {
                if (mask[i] != 0 && !std::isnan(map[i])) total += value(map[i]);
            }
            return total;
        });
    };
    return sum([](float v) { return static_cast<double>(v); }) / sum([](float) { return 1.0; });
}

}  // namespace postlens
