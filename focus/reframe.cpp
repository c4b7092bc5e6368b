#include "focus/reframe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/threads.h"

namespace postlens {
namespace {

/// To magnify an image, each output pixel is computed from the traced pixels that it covers. Along one axis,
/// a Box lists these traced pixels, from the pixel `first` on, and the fraction of the output pixel that each
/// of them fills.
struct Box {
    int first = 0;
    std::vector<double> share;  ///< adds up to 1
};

/// Tolerance for rounding errors of pixel borders, in px.
constexpr double rounding_px = 1e-9;

double traced_position(double position, int size, double zoom) {
    return size / 2.0 + (position - size / 2.0) / zoom;
}

std::vector<Box> boxes(int size, int begin, int end, double zoom) {
    std::vector<Box> out(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
        const double low = std::max(traced_position(i, size, zoom), static_cast<double>(begin));
        const double high = std::min(traced_position(i + 1, size, zoom), static_cast<double>(end));
        Box& box = out[static_cast<std::size_t>(i)];
        box.first = std::clamp(static_cast<int>(std::floor(low + rounding_px)), begin, end - 1);
        for (int x = box.first; x < end && (x == box.first || x < high - rounding_px); ++x) {
            const double covered = std::min<double>(high, x + 1) - std::max<double>(low, x);
            box.share.push_back(std::max(0.0, covered) / (high - low));
        }
    }
    return out;
}

}  // namespace

RasterWindow window_for_zoom(int width, int height, double zoom) {
    const auto low = [&](int size) {
        return static_cast<int>(std::floor(traced_position(0, size, zoom) + rounding_px));
    };
    const auto high = [&](int size) {
        return static_cast<int>(std::ceil(traced_position(size, size, zoom) - rounding_px));
    };
    return {low(width), high(width), low(height), high(height)};
}

Image reframe(const Image& traced, const RasterWindow& window, int width, int height, double zoom) {
    const std::vector<Box> columns = boxes(width, window.x_begin, window.x_end, zoom);
    const std::vector<Box> rows = boxes(height, window.y_begin, window.y_end, zoom);
    Image out(width, height);
    parallel_for(
        rows.size(),
        [&](std::size_t y) {
            const Box& row = rows[y];
            // Each output pixel is the mean of a box of traced pixels. For each traced column, the mean over
            // the rows of this box is computed first. Thus, the traced pixels are read in the order in which
            // they lie in memory.
            std::vector<double> mean(3 * static_cast<std::size_t>(window.width()));
            for (std::size_t j = 0; j < row.share.size(); ++j) {
                const float* from = traced.pixel(0, row.first + static_cast<int>(j) - window.y_begin);
                for (std::size_t i = 0; i < mean.size(); ++i)
                    mean[i] += row.share[j] * static_cast<double>(from[i]);
            }
            // Each output pixel is the mean over the columns of its box.
            for (int x = 0; x < width; ++x) {
                const Box& column = columns[static_cast<std::size_t>(x)];
                std::array<double, 3> sum{};
                for (std::size_t j = 0; j < column.share.size(); ++j) {
                    const double* from =
                        mean.data() + 3 * (static_cast<std::size_t>(column.first - window.x_begin) + j);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += column.share[j] * from[c];
                }
                std::transform(sum.begin(), sum.end(), out.pixel(x, static_cast<int>(y)),
                               [](double v) { return static_cast<float>(v); });
            }
        },
        16);
    return out;
}

}  // namespace postlens
