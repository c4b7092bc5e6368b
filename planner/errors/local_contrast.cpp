#include "planner/errors/local_contrast.h"

#include <algorithm>

#include "core/threads.h"
#include "pictures/srgb.h"

namespace postlens {

std::vector<float> local_contrast(const Image& image) {
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    const std::size_t stride = width + 1;
    std::vector<double> sums(3 * stride * (height + 1), 0), squares(stride * (height + 1), 0);
    for (std::size_t y = 0; y < height; ++y) {
        double row[3] = {0, 0, 0}, row_squares = 0;
        for (std::size_t x = 0; x < width; ++x) {
            for (std::size_t c = 0; c < 3; ++c) {
                const auto v = static_cast<double>(srgb_from_linear(image.rgb[3 * (y * width + x) + c]));
                row[c] += v;
                row_squares += v * v;
            }
            const std::size_t to = (y + 1) * stride + x + 1, above = y * stride + x + 1;
            for (std::size_t c = 0; c < 3; ++c) sums[3 * to + c] = sums[3 * above + c] + row[c];
            squares[to] = squares[above] + row_squares;
        }
    }
    std::vector<float> out(width * height);
    constexpr std::size_t radius = 32;  // px, on each side of the pixel
    parallel_for(height, [&](std::size_t y) {
        const std::size_t y0 = y - std::min(y, radius), y1 = std::min(y + radius + 1, height);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t x0 = x - std::min(x, radius), x1 = std::min(x + radius + 1, width);
            const auto over = [&](const std::vector<double>& of, std::size_t channels, std::size_t c) {
                return of[channels * (y1 * stride + x1) + c] - of[channels * (y0 * stride + x1) + c] -
                       of[channels * (y1 * stride + x0) + c] + of[channels * (y0 * stride + x0) + c];
            };
            const auto n = static_cast<double>((y1 - y0) * (x1 - x0));
            double variance = over(squares, 1, 0) / n;
            for (std::size_t c = 0; c < 3; ++c) {
                const double mean = over(sums, 3, c) / n;
                variance -= mean * mean;
            }
            out[y * width + x] = static_cast<float>(std::max(0.0, variance / 3));
        }
    });
    return out;
}

}  // namespace postlens
