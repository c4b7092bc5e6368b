#include "motionblur/convolution/convolution.h"

#include <algorithm>
#include <limits>

#include "motionblur/convolution/convolution_task.h"
#include "motionblur/convolution/direct_convolution.h"
#include "motionblur/convolution/fft_convolution.h"

namespace postlens {
namespace {

bool is_empty(const CellWindow& w) {
    return w.width() <= 0 || w.height() <= 0;
}

CellWindow result_window(const Planes& i1, const PathRaster& i2, const std::optional<CellWindow>& wanted) {
    const CellWindow a = window_of(i1), b = window_of(i2);
    if (is_empty(a) || is_empty(b)) return {};
    CellWindow out = full_window(a, b);
    if (wanted) {
        out = {std::max(out.x_begin, wanted->x_begin), std::min(out.x_end, wanted->x_end),
               std::max(out.y_begin, wanted->y_begin), std::min(out.y_end, wanted->y_end)};
    }
    return is_empty(out) ? CellWindow{} : out;
}

}  // namespace

Planes convolve(const Planes& i1, const PathRaster& i2, ConvolutionMethod method, ConvolutionMethod* used,
                const std::optional<CellWindow>& wanted) {
    const CellWindow window = result_window(i1, i2, wanted);
    const ConvolutionTask task(i1, i2, window);
    if (method == ConvolutionMethod::automatic) {
        method = direct_cost_s(task) <= fft_cost_s(task) ? ConvolutionMethod::direct : ConvolutionMethod::fft;
    }
    if (used != nullptr) *used = method;
    Planes out = zero_planes(window, i1.planes.size());
    if (method == ConvolutionMethod::direct) {
        convolve_direct(task, out);
    } else {
        convolve_fft(task, out);
    }
    return out;
}

Planes convolve_reference(const Planes& i1, const PathRaster& i2) {
    Planes out = zero_planes(result_window(i1, i2, std::nullopt), i1.planes.size());
    const auto index = [](int x, int y, int width) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    for (std::size_t p = 0; p < i1.planes.size(); ++p) {
        std::vector<double> sums(out.planes[p].size());
        for (int j = 0; j < i2.height; ++j) {
            for (int i = 0; i < i2.width; ++i) {
                const double weight = i2.weight[index(i, j, i2.width)];
                if (weight == 0) continue;
                for (int y = 0; y < i1.height; ++y)
                    for (int x = 0; x < i1.width; ++x)
                        sums[index(x + i, y + j, out.width)] +=
                            weight * static_cast<double>(i1.planes[p][index(x, y, i1.width)]);
            }
        }
        for (std::size_t i = 0; i < sums.size(); ++i) out.planes[p][i] = static_cast<float>(sums[i]);
    }
    return out;
}

ConvolutionCosts predict_costs(const Planes& i1, const PathRaster& i2,
                               const std::optional<CellWindow>& wanted) {
    const ConvolutionTask task(i1, i2, result_window(i1, i2, wanted));
    return {direct_cost_s(task), fft_cost_s(task)};
}

}  // namespace postlens
