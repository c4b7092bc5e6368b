#include "focus/layers/layer_sums.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/multiversion.h"

namespace postlens {
namespace {

// Alias declarations would lose the attributes.
// NOLINTBEGIN(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32)));
typedef double EightDoubles __attribute__((vector_size(64)));
/// Vector types that are only used to load values from memory and to store them there, at addresses that may
/// be unaligned. Variables have the aligned types FourDoubles and EightDoubles instead, because the compiler
/// keeps only aligned types in registers.
typedef double FourStored __attribute__((vector_size(32), aligned(8), may_alias));
typedef double EightStored __attribute__((vector_size(64), aligned(8), may_alias));
// NOLINTEND(modernize-use-using)

/// The values of one sample, such as its colour and weight. For each pixel that the blurred sample reaches,
/// they are multiplied by the value of the blur kernel there, and added to the pixel's sums. Their order is
/// that of LayerSums::sums_.
struct PlainValues {
    static constexpr std::size_t count = LayerSums::plain_values;
    EightDoubles light;

    PlainValues() = default;
    PlainValues(const LayerSplat& s, int /*x*/, int /*y*/) {
        const auto r = static_cast<double>(s.r), g = static_cast<double>(s.g), b = static_cast<double>(s.b),
                   weight = static_cast<double>(s.weight), lens_per_px = static_cast<double>(s.lens_per_px);
        light = EightDoubles{r,
                             g,
                             b,
                             weight,
                             static_cast<double>(s.depth),
                             static_cast<double>(s.covered),
                             (r + g + b) * lens_per_px,
                             weight * lens_per_px};
    }
    __attribute__((always_inline)) void add(const PlainValues& other, double tap) {
        light += other.light * tap;
    }
    __attribute__((always_inline)) void add_to(double* pixel) const {
        *reinterpret_cast<EightStored*>(pixel) += light;
    }
};

struct LensValues {
    static constexpr std::size_t count = LayerSums::lens_values;
    PlainValues plain;
    FourDoubles moments;  ///< the last two values of `plain`, times x and times y

    LensValues() = default;
    /// (x, y) is the sample's position within the block of pixels.
    LensValues(const LayerSplat& s, int x, int y) : plain(s, x, y) {
        const double column = x, row = y;
        moments = FourDoubles{plain.light[6] * column, plain.light[7] * column, plain.light[6] * row,
                              plain.light[7] * row};
    }
    __attribute__((always_inline)) void add(const LensValues& other, double tap) {
        plain.add(other.plain, tap);
        moments += other.moments * tap;
    }
    __attribute__((always_inline)) void add_to(double* pixel) const {
        plain.add_to(pixel);
        *reinterpret_cast<FourStored*>(pixel + PlainValues::count) += moments;
    }
};

struct LayerPass {
    std::span<const LayerSplat> splats;
    const KernelTable* kernels = nullptr;
    std::size_t channel = 0;
    RasterWindow rows;
    double* sums = nullptr;
    double* changes = nullptr;
    std::vector<double>* taps = nullptr;  ///< buffer
};

/// Largest number of splats that one call of add_run adds.
constexpr std::size_t longest_run = 64;
/// Number of zeros before and after a row of samples in memory, so that short convolutions need no test for
/// the row's ends.
constexpr std::size_t padding = 8;

/// Returns how many samples of the list `splats`, from the first one on, can be blurred together. These
/// samples lie in adjacent pixels of a row and have the same blur kernel. Returns 0 if the blur of the first
/// sample does not reach the window of pixels `rows`.
__attribute__((always_inline)) inline std::size_t run_length(std::span<const LayerSplat> splats,
                                                             const Reach& reach, const RasterWindow& rows) {
    const LayerSplat& s = splats[0];
    if (s.y + reach.dy_end <= rows.y_begin || s.y + reach.dy_begin >= rows.y_end ||
        s.x + reach.dx_end <= rows.x_begin)
        return 0;
    const int reaching = std::max(0, rows.x_end - reach.dx_begin - s.x);
    const std::size_t most = std::min({splats.size(), longest_run, static_cast<std::size_t>(reaching)});
    std::size_t n = 0;
    while (n < most && splats[n].kernel == s.kernel && splats[n].x == s.x + static_cast<int>(n)) ++n;
    return n;
}

/// Convolves a row of samples (`values`) with a short row of a blur kernel (`taps`), and adds the result to
/// `pixels`. The length of the kernel row is a template argument, so that the compiler can unroll the loop
/// over it.
template <typename Values, int taps_end>
__attribute__((always_inline)) inline void convolve_few(const Values* values, const double* taps, int count,
                                                        double* pixels) {
    // A local copy, so that the compiler knows that writing to `pixels` does not change the kernel values.
    std::array<double, taps_end> tap;
    std::copy_n(taps, taps_end, tap.begin());
    for (int i = 0; i < count; ++i) {
        Values sum{};
        for (int k = 0; k < taps_end; ++k) sum.add(values[i - k], tap[static_cast<std::size_t>(k)]);
        sum.add_to(pixels + Values::count * static_cast<std::size_t>(i));
    }
}

/// Convolves samples (`values`) with a kernel row (`taps`), and adds the result to a row of pixels.
/// - `values`: with `padding` zeros before and after them in memory
/// - `first`: pixel of `row` to which the product values[0] * taps[0] is added
/// - `begin`, `end`: range of the pixels in `row`
template <typename Values>
__attribute__((always_inline)) inline void convolve(std::span<const Values> values,
                                                    std::span<const double> taps, int first, int begin,
                                                    int end, double* row) {
    const int last = static_cast<int>(values.size()) - 1, last_tap = static_cast<int>(taps.size()) - 1;
    const int from = std::max(begin, first), to = std::min(end, first + last + last_tap + 1);
    const auto add_few = [&]<int taps_end>() __attribute__((always_inline)) {
        convolve_few<Values, taps_end>(values.data() + (from - first), taps.data(), to - from,
                                       row + Values::count * static_cast<std::size_t>(from));
    };
    const auto add_if_few = [&]<std::size_t... n>(std::index_sequence<n...>) __attribute__((always_inline)) {
        return ((taps.size() == n + 1 && (add_few.template operator()<static_cast<int>(n) + 1>(), true)) ||
                ...);
    };
    if (add_if_few(std::make_index_sequence<1 + padding>())) return;
    for (int at = from; at < to; ++at) {
        Values sum{};
        const int tap_end = std::min(last_tap, at - first);
        for (int tap = std::max(0, at - first - last); tap <= tap_end; ++tap)
            sum.add(values[static_cast<std::size_t>(at - first - tap)], taps[static_cast<std::size_t>(tap)]);
        sum.add_to(row + Values::count * static_cast<std::size_t>(at));
    }
}

__attribute__((always_inline)) inline void set_differences(const float* edge, int count, double before,
                                                           double after, std::vector<double>& taps) {
    taps.resize(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i < count; ++i) {
        const auto value = static_cast<double>(edge[i]);
        taps[static_cast<std::size_t>(i)] = value - before;
        before = value;
    }
    taps.back() = after - before;
}

/// Blurs samples that lie side by side in a row and have the same kernel, and adds them to one row of pixels.
/// `row` is the row of the kernel that reaches these pixels.
template <typename Values>
__attribute__((always_inline)) inline void add_run(std::span<const Values> values, const Kernel& kernel,
                                                   const KernelRow& row, int x, int width, double* sums,
                                                   double* changes, std::vector<double>& taps) {
    const float* tap = kernel.taps.data() + row.tap;
    if (row.inner_begin == row.inner_end) {
        taps.assign(tap, tap + (row.x_end - row.x_begin));
        convolve<Values>(values, taps, x + row.x_begin, 0, width, sums);
        return;
    }
    int from = 0;
    if (x + row.x_begin < 0) {
        Values sum{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const int column = -x - static_cast<int>(i);
            if (column >= row.x_begin && column < row.x_end) sum.add(values[i], kernel.at(row, column));
        }
        sum.add_to(changes);
        from = 1;
    }
    const auto inner = static_cast<double>(kernel.inner);
    const int left = row.inner_begin - row.x_begin, right = row.x_end - row.inner_end;
    set_differences(tap, left, 0, inner, taps);
    convolve<Values>(values, taps, x + row.x_begin, from, width, changes);
    set_differences(tap + left, right, inner, 0, taps);
    convolve<Values>(values, taps, x + row.inner_end, from, width, changes);
}

/// Multiplies one sample by a row of its blur kernel, and adds the products to a row of pixels.
template <typename Values>
__attribute__((always_inline)) inline void add_one(const Values& values, const Kernel& kernel,
                                                   const KernelRow& row, int x, int width, double* sums,
                                                   double* changes) {
    const auto add = [&](double* pixels, int at, double tap) __attribute__((always_inline)) {
        Values product{};
        product.add(values, tap);
        product.add_to(pixels + Values::count * static_cast<std::size_t>(at));
    };
    const auto add_taps = [&](const float* taps, int begin, int end) __attribute__((always_inline)) {
        const int to = std::min(end, width);
        for (int at = std::max(begin, 0); at < to; ++at) add(sums, at, static_cast<double>(taps[at - begin]));
    };
    const float* taps = kernel.taps.data() + row.tap;
    const int left_end = x + row.inner_begin, right_begin = x + row.inner_end;
    add_taps(taps, x + row.x_begin, left_end);
    if (right_begin == left_end) return;
    add_taps(taps + (row.inner_begin - row.x_begin), right_begin, x + row.x_end);
    if (left_end >= width || right_begin <= 0) return;
    const auto inner = static_cast<double>(kernel.inner);
    add(changes, std::max(left_end, 0), inner);
    add(changes, std::min(right_begin, width), -inner);
}

template <typename Values>
__attribute__((always_inline)) inline void add_splats(const LayerPass& pass) {
    const int width = pass.rows.width();
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): too large to be set to 0 in each call
    std::array<Values, padding + longest_run + padding> values;
    std::fill_n(values.begin(), padding, Values{});
    for (std::size_t i = 0; i < pass.splats.size();) {
        const std::size_t run =
            run_length(pass.splats.subspan(i), pass.kernels->reach(pass.splats[i].kernel), pass.rows);
        if (run == 0) {
            ++i;
            continue;
        }
        const LayerSplat& s = pass.splats[i];
        const int x = s.x - pass.rows.x_begin;
        for (std::size_t k = 0; k < run; ++k)
            values[padding + k] =
                Values(pass.splats[i + k], x + static_cast<int>(k), s.y - pass.rows.y_begin);
        std::fill_n(values.data() + padding + run, padding, Values{});
        i += run;
        const Kernel& kernel = pass.kernels->kernel(s.kernel, pass.channel);
        const int first = std::max(pass.rows.y_begin, s.y + kernel.y_begin);
        const int last = std::min(pass.rows.y_end, s.y + kernel.y_end());
        for (int y = first; y < last; ++y) {
            const std::size_t offset = Values::count * static_cast<std::size_t>(width + 1) *
                                       static_cast<std::size_t>(y - pass.rows.y_begin);
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - s.y - kernel.y_begin)];
            double* sums = pass.sums + offset;
            double* changes = pass.changes + offset;
            if (run == 1) {
                add_one(values[padding], kernel, row, x, width, sums, changes);
            } else {
                add_run<Values>(std::span(values).subspan(padding, run), kernel, row, x, width, sums, changes,
                                *pass.taps);
            }
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

/// Adds a row of `width` pixels to `sums`. Each pixel has `numbers` values. The row is stored in `changes` as
/// differences: each pixel contains its values minus those of the pixel on its left. So the values themselves
/// are the cumulative sums of `changes`.
template <std::size_t numbers>
__attribute__((always_inline)) inline void sum_row(double* sums, const double* changes, std::size_t width) {
    double inside[numbers] = {};
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t c = 0; c < numbers; ++c) {
            inside[c] += changes[numbers * i + c];
            sums[numbers * i + c] += inside[c];
        }
    }
}

POSTLENS_MULTIVERSION
void sum_plain_row(double* sums, const double* changes, std::size_t width) {
    sum_row<PlainValues::count>(sums, changes, width);
}

POSTLENS_MULTIVERSION
void sum_lens_row(double* sums, const double* changes, std::size_t width) {
    sum_row<LensValues::count>(sums, changes, width);
}

}  // namespace

void LayerSums::begin(const RasterWindow& rows, bool with_lens, double from_anchor_px) {
    rows_ = rows;
    from_anchor_px_ = from_anchor_px;
    with_lens_ = with_lens;
    width_ = static_cast<std::size_t>(rows.width()) + 1;
    stride_ = with_lens ? lens_values : plain_values;
    const std::size_t count = stride_ * width_ * static_cast<std::size_t>(rows.height());
    sums_.assign(count, 0.0);
    changes_.assign(count, 0.0);
}

void LayerSums::add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel) {
    (with_lens_ ? add_with_lens : add_plain)({.splats = splats,
                                              .kernels = &kernels,
                                              .channel = channel,
                                              .rows = rows_,
                                              .sums = sums_.data(),
                                              .changes = changes_.data(),
                                              .taps = &taps_});
}

void LayerSums::finish() {
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows_.height()); ++row) {
        const std::size_t offset = stride_ * width_ * row;
        (with_lens_ ? sum_lens_row : sum_plain_row)(sums_.data() + offset, changes_.data() + offset,
                                                    width_ - 1);
    }
}

LensMoments LayerSums::lens_at(int x, int y) const {
    if (!with_lens_) return {};
    const double* sums = at(x, y);
    const double px = x - rows_.x_begin + 0.5 - from_anchor_px_,
                 py = y - rows_.y_begin + 0.5 - from_anchor_px_;
    return {.rgb = {px * sums[6] - sums[8], py * sums[6] - sums[10]},
            .alpha = {px * sums[7] - sums[9], py * sums[7] - sums[11]}};
}

}  // namespace postlens
