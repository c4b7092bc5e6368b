#include "focus/layer_sums.h"

#include <algorithm>

#include "core/multiversion.h"

namespace postlens {
namespace {

// An alias declaration would lose the attributes.
// NOLINTNEXTLINE(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));

struct LayerPass {
    const LayerSplat* splats;
    std::size_t count;
    const KernelTable* kernels;
    std::size_t channel;
    RasterWindow rows;
    std::size_t stride;
    double* sum;
    double* change;
    double* depth;
    double* depth_change;
};

POSTLENS_MULTIVERSION
void add_splats(const LayerPass& pass) {
    const int width = pass.rows.x_end - pass.rows.x_begin;
    for (std::size_t i = 0; i < pass.count; ++i) {
        const LayerSplat& s = pass.splats[i];
        const Kernel& kernel = pass.kernels->kernel(s.kernel, pass.channel);
        // Columns from the first.
        const int x = s.x - pass.rows.x_begin;
        if (x + kernel.x_end <= 0 || x + kernel.x_begin >= width) continue;
        const FourDoubles value = {static_cast<double>(s.r), static_cast<double>(s.g),
                                   static_cast<double>(s.b), static_cast<double>(s.weight)};
        const double depth = s.depth;
        const FourDoubles inner = value * static_cast<double>(kernel.inner);
        const double inner_depth = depth * static_cast<double>(kernel.inner);
        const int first = std::max(pass.rows.y_begin, s.y + kernel.y_begin);
        const int last = std::min(pass.rows.y_end, s.y + kernel.y_end());
        for (int y = first; y < last; ++y) {
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
            const std::size_t offset = static_cast<std::size_t>(y - pass.rows.y_begin) * pass.stride;
            double* sum = pass.sum + 4 * offset;
            double* depth_sum = pass.depth + offset;
            const auto add_taps = [&](const float* taps, int begin, int end) {
                const int to = std::min(end, width);
                for (int at = std::max(begin, 0); at < to; ++at) {
                    const double tap = taps[at - begin];
                    *reinterpret_cast<FourDoubles*>(sum + 4 * at) += value * tap;
                    depth_sum[at] += depth * tap;
                }
            };
            const float* taps = kernel.taps.data() + row.tap;
            const int left_end = x + row.inner_begin, right_begin = x + row.inner_end;
            add_taps(taps, x + row.x_begin, left_end);
            if (right_begin == left_end) continue;
            add_taps(taps + (row.inner_begin - row.x_begin), right_begin, x + row.x_end);
            if (left_end >= width || right_begin <= 0) continue;
            const int from = std::max(left_end, 0), to = std::min(right_begin, width);
            double* change = pass.change + 4 * offset;
            *reinterpret_cast<FourDoubles*>(change + 4 * from) += inner;
            *reinterpret_cast<FourDoubles*>(change + 4 * to) -= inner;
            pass.depth_change[offset + static_cast<std::size_t>(from)] += inner_depth;
            pass.depth_change[offset + static_cast<std::size_t>(to)] -= inner_depth;
        }
    }
}

}  // namespace

void LayerSums::begin(const RasterWindow& rows) {
    rows_ = rows;
    stride_ = static_cast<std::size_t>(rows.width()) + 1;
    const std::size_t count = stride_ * static_cast<std::size_t>(rows.height());
    sum_.assign(4 * count, 0.0);
    change_.assign(4 * count, 0.0);
    depth_.assign(count, 0.0);
    depth_change_.assign(count, 0.0);
}

void LayerSums::add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel) {
    add_splats({.splats = splats.data(),
                .count = splats.size(),
                .kernels = &kernels,
                .channel = channel,
                .rows = rows_,
                .stride = stride_,
                .sum = sum_.data(),
                .change = change_.data(),
                .depth = depth_.data(),
                .depth_change = depth_change_.data()});
}

void LayerSums::finish() {
    for (int y = 0; y < rows_.height(); ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * stride_;
        double inside[4] = {}, inside_depth = 0;
        for (std::size_t i = row; i + 1 < row + stride_; ++i) {
            for (std::size_t c = 0; c < 4; ++c) {
                inside[c] += change_[4 * i + c];
                sum_[4 * i + c] += inside[c];
            }
            inside_depth += depth_change_[i];
            depth_[i] += inside_depth;
        }
    }
}

}  // namespace postlens
