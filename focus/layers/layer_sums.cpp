#include "focus/layers/layer_sums.h"

#include <algorithm>

#include "core/multiversion.h"

namespace postlens {
namespace {

// An alias declaration would lose the attributes.
// NOLINTNEXTLINE(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));

// NOLINTNEXTLINE(readability-non-const-parameter): what it points to is written through the result
FourDoubles& four_at(double* p) {
    return *reinterpret_cast<FourDoubles*>(p);
}

struct LayerPass {
    const LayerSplat* splats = nullptr;
    std::size_t count = 0;
    const KernelTable* kernels = nullptr;
    std::size_t channel = 0;
    RasterWindow rows;
    std::size_t width = 0;
    double* sum = nullptr;
    double* change = nullptr;
    double* depth = nullptr;
    double* depth_change = nullptr;
    double* covered = nullptr;
    double* covered_change = nullptr;
};

/// Adds splats to a block. `vectors`: number of groups of four sums per pixel; 4 with lens moments, otherwise
/// 1.
template <std::size_t vectors>
__attribute__((always_inline)) inline void add_splats(const LayerPass& pass) {
    const int width = pass.rows.x_end - pass.rows.x_begin;
    for (std::size_t i = 0; i < pass.count; ++i) {
        const LayerSplat& s = pass.splats[i];
        const Kernel& kernel = pass.kernels->kernel(s.kernel, pass.channel);
        // Column of the anchor, relative to the block.
        const int x = s.x - pass.rows.x_begin;
        if (x + kernel.x_end <= 0 || x + kernel.x_begin >= width) continue;
        FourDoubles value[vectors];
        value[0] = FourDoubles{static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                               static_cast<double>(s.weight)};
        if constexpr (vectors == 4) {
            value[1] = value[0] * static_cast<double>(s.lens_per_px);
            value[2] = value[1] * static_cast<double>(x);
            value[3] = value[1] * static_cast<double>(s.y - pass.rows.y_begin);
        }
        const double inner = kernel.inner, depth = s.depth, covered = s.covered;
        const int first = std::max(pass.rows.y_begin, s.y + kernel.y_begin);
        const int last = std::min(pass.rows.y_end, s.y + kernel.y_end());
        for (int y = first; y < last; ++y) {
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
            const std::size_t offset = static_cast<std::size_t>(y - pass.rows.y_begin) * pass.width;
            double* sum = pass.sum + 4 * vectors * offset;
            double* depth_sum = pass.depth + offset;
            double* covered_sum = pass.covered + offset;
            const auto add_taps = [&](const float* taps, int begin, int end) {
                const int to = std::min(end, width);
                for (int at = std::max(begin, 0); at < to; ++at) {
                    const double tap = taps[at - begin];
                    double* pixel = sum + 4 * vectors * static_cast<std::size_t>(at);
                    for (std::size_t v = 0; v < vectors; ++v) four_at(pixel + 4 * v) += value[v] * tap;
                    depth_sum[at] += depth * tap;
                    covered_sum[at] += covered * tap;
                }
            };
            const float* taps = kernel.taps.data() + row.tap;
            const int left_end = x + row.inner_begin, right_begin = x + row.inner_end;
            add_taps(taps, x + row.x_begin, left_end);
            if (right_begin == left_end) continue;
            add_taps(taps + (row.inner_begin - row.x_begin), right_begin, x + row.x_end);
            if (left_end >= width || right_begin <= 0) continue;
            const auto from = offset + static_cast<std::size_t>(std::max(left_end, 0));
            const auto to = offset + static_cast<std::size_t>(std::min(right_begin, width));
            for (std::size_t v = 0; v < vectors; ++v) {
                four_at(pass.change + 4 * (vectors * from + v)) += value[v] * inner;
                four_at(pass.change + 4 * (vectors * to + v)) -= value[v] * inner;
            }
            pass.depth_change[from] += depth * inner;
            pass.depth_change[to] -= depth * inner;
            pass.covered_change[from] += covered * inner;
            pass.covered_change[to] -= covered * inner;
        }
    }
}

POSTLENS_MULTIVERSION
void add_plain(const LayerPass& pass) {
    add_splats<1>(pass);
}

POSTLENS_MULTIVERSION
void add_with_lens(const LayerPass& pass) {
    add_splats<4>(pass);
}

/// Adds the prefix sums of the differences to the first `width` pixels of a row.
template <std::size_t numbers>
void sum_row(double* sum, const double* change, std::size_t width) {
    double inside[numbers] = {};
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t c = 0; c < numbers; ++c) {
            inside[c] += change[numbers * i + c];
            sum[numbers * i + c] += inside[c];
        }
    }
}

}  // namespace

void LayerSums::begin(const RasterWindow& rows, bool with_lens, double from_anchor_px) {
    rows_ = rows;
    from_anchor_px_ = from_anchor_px;
    with_lens_ = with_lens;
    width_ = static_cast<std::size_t>(rows.width()) + 1;
    stride_ = with_lens ? 16 : 4;
    const std::size_t count = width_ * static_cast<std::size_t>(rows.height());
    sum_.assign(stride_ * count, 0.0);
    change_.assign(stride_ * count, 0.0);
    depth_.assign(count, 0.0);
    depth_change_.assign(count, 0.0);
    covered_.assign(count, 0.0);
    covered_change_.assign(count, 0.0);
}

void LayerSums::add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel) {
    (with_lens_ ? add_with_lens : add_plain)({.splats = splats.data(),
                                              .count = splats.size(),
                                              .kernels = &kernels,
                                              .channel = channel,
                                              .rows = rows_,
                                              .width = width_,
                                              .sum = sum_.data(),
                                              .change = change_.data(),
                                              .depth = depth_.data(),
                                              .depth_change = depth_change_.data(),
                                              .covered = covered_.data(),
                                              .covered_change = covered_change_.data()});
}

void LayerSums::finish() {
    const auto width = static_cast<std::size_t>(rows_.width());
    for (int y = 0; y < rows_.height(); ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * width_;
        (with_lens_ ? sum_row<16> : sum_row<4>)(sum_.data() + stride_ * row, change_.data() + stride_ * row,
                                                width);
        sum_row<1>(depth_.data() + row, depth_change_.data() + row, width);
        sum_row<1>(covered_.data() + row, covered_change_.data() + row, width);
    }
}

std::array<LensMoment, 4> LayerSums::lens_at(int x, int y) const {
    std::array<LensMoment, 4> out{};
    if (!with_lens_) return out;
    const double* sums = at(x, y);
    const double px = x - rows_.x_begin + 0.5 - from_anchor_px_,
                 py = y - rows_.y_begin + 0.5 - from_anchor_px_;
    for (std::size_t c = 0; c < 4; ++c) {
        out[c] = {px * sums[4 + c] - sums[8 + c], py * sums[4 + c] - sums[12 + c]};
    }
    return out;
}

}  // namespace postlens
