#include "focus/layers/layer_sums.h"

#include <algorithm>

#include "core/multiversion.h"

namespace postlens {
namespace {

// Alias declarations would lose the attributes.
// NOLINTBEGIN(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));
typedef double TwoDoubles __attribute__((vector_size(16), aligned(8), may_alias));
// NOLINTEND(modernize-use-using)

/// The numbers of one splat that are added to a pixel, each times the kernel.
struct PlainValues {
    static constexpr std::size_t count = 6;
    FourDoubles light;
    TwoDoubles depth;

    PlainValues(const LayerSplat& s, int /*x*/, int /*y*/)
        : light{static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                static_cast<double>(s.weight)},
          depth{static_cast<double>(s.depth), static_cast<double>(s.covered)} {}
    __attribute__((always_inline)) void add_to(double* pixel, double tap) const {
        *reinterpret_cast<FourDoubles*>(pixel) += light * tap;
        *reinterpret_cast<TwoDoubles*>(pixel + 4) += depth * tap;
    }
};

/// As PlainValues, with the sums from which lens_at() finds the lens moments: the light times the lens point
/// per px, and this times the splat's position. Vectors of eight would be split by way of the stack on
/// processors without AVX-512, which takes twice as long.
struct LensValues {
    static constexpr std::size_t count = 18;
    FourDoubles light, by_lens, by_x, by_y;
    TwoDoubles depth;

    /// `x`, `y`: the splat's anchor, counted from the corner of the block.
    LensValues(const LayerSplat& s, int x, int y)
        : light{static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                static_cast<double>(s.weight)},
          by_lens(light * static_cast<double>(s.lens_per_px)),
          by_x(by_lens * static_cast<double>(x)),
          by_y(by_lens * static_cast<double>(y)),
          depth{static_cast<double>(s.depth), static_cast<double>(s.covered)} {}
    __attribute__((always_inline)) void add_to(double* pixel, double tap) const {
        *reinterpret_cast<FourDoubles*>(pixel) += light * tap;
        *reinterpret_cast<FourDoubles*>(pixel + 4) += by_lens * tap;
        *reinterpret_cast<FourDoubles*>(pixel + 8) += by_x * tap;
        *reinterpret_cast<FourDoubles*>(pixel + 12) += by_y * tap;
        *reinterpret_cast<TwoDoubles*>(pixel + 16) += depth * tap;
    }
};

struct LayerPass {
    const LayerSplat* splats = nullptr;
    std::size_t count = 0;
    const KernelTable* kernels = nullptr;
    std::size_t channel = 0;
    RasterWindow rows;
    double* sums = nullptr;
    double* changes = nullptr;
};

/// Adds splats to a block.
template <typename Values>
__attribute__((always_inline)) inline void add_splats(const LayerPass& pass) {
    const int width = pass.rows.width();
    for (std::size_t i = 0; i < pass.count; ++i) {
        const LayerSplat& s = pass.splats[i];
        if (!s.reaches(pass.rows)) continue;
        const Kernel& kernel = pass.kernels->kernel(s.kernel, pass.channel);
        // Column of the anchor, relative to the block.
        const int x = s.x - pass.rows.x_begin;
        const Values values(s, x, s.y - pass.rows.y_begin);
        const double inner = kernel.inner;
        const int first = std::max(pass.rows.y_begin, s.y + kernel.y_begin);
        const int last = std::min(pass.rows.y_end, s.y + kernel.y_end());
        for (int y = first; y < last; ++y) {
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
            const std::size_t offset = Values::count * static_cast<std::size_t>(width + 1) *
                                       static_cast<std::size_t>(y - pass.rows.y_begin);
            const auto add_taps = [&](const float* taps, int begin, int end) {
                const int to = std::min(end, width);
                for (int at = std::max(begin, 0); at < to; ++at)
                    values.add_to(pass.sums + offset + Values::count * static_cast<std::size_t>(at),
                                  static_cast<double>(taps[at - begin]));
            };
            const float* taps = kernel.taps.data() + row.tap;
            const int left_end = x + row.inner_begin, right_begin = x + row.inner_end;
            add_taps(taps, x + row.x_begin, left_end);
            if (right_begin == left_end) continue;
            add_taps(taps + (row.inner_begin - row.x_begin), right_begin, x + row.x_end);
            if (left_end >= width || right_begin <= 0) continue;
            double* changes = pass.changes + offset;
            values.add_to(changes + Values::count * static_cast<std::size_t>(std::max(left_end, 0)), inner);
            values.add_to(changes + Values::count * static_cast<std::size_t>(std::min(right_begin, width)),
                          -inner);
        }
    }
}

POSTLENS_MULTIVERSION
void add_plain(const LayerPass& pass) {
    add_splats<PlainValues>(pass);
}

POSTLENS_MULTIVERSION
void add_with_lens(const LayerPass& pass) {
    add_splats<LensValues>(pass);
}

/// Adds the prefix sums of `changes` to `sums`. `changes` has the differences between neighbouring pixels of
/// a row of `width` pixels, with `numbers` values per pixel.
template <std::size_t numbers>
void sum_row(double* sums, const double* changes, std::size_t width) {
    double inside[numbers] = {};
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t c = 0; c < numbers; ++c) {
            inside[c] += changes[numbers * i + c];
            sums[numbers * i + c] += inside[c];
        }
    }
}

}  // namespace

void LayerSums::begin(const RasterWindow& rows, bool with_lens, double from_anchor_px) {
    rows_ = rows;
    from_anchor_px_ = from_anchor_px;
    with_lens_ = with_lens;
    width_ = static_cast<std::size_t>(rows.width()) + 1;
    stride_ = with_lens ? LensValues::count : PlainValues::count;
    const std::size_t count = stride_ * width_ * static_cast<std::size_t>(rows.height());
    sums_.assign(count, 0.0);
    changes_.assign(count, 0.0);
}

void LayerSums::add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel) {
    (with_lens_ ? add_with_lens : add_plain)({.splats = splats.data(),
                                              .count = splats.size(),
                                              .kernels = &kernels,
                                              .channel = channel,
                                              .rows = rows_,
                                              .sums = sums_.data(),
                                              .changes = changes_.data()});
}

void LayerSums::finish() {
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows_.height()); ++row) {
        const std::size_t offset = stride_ * width_ * row;
        (with_lens_ ? sum_row<LensValues::count> : sum_row<PlainValues::count>)(sums_.data() + offset,
                                                                                changes_.data() + offset,
                                                                                width_ - 1);
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
