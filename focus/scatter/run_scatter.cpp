#include "focus/scatter/run_scatter.h"

#include <algorithm>
#include <array>

#include "core/floor_div.h"
#include "core/multiversion.h"

namespace postlens {
namespace {

/// Rows of samples that are summed in float before the sums are added in double. With so few rows, the
/// rounding error of float does not matter.
constexpr int source_rows_per_flush = 32;
/// The image is computed in strips of 64 columns. This many rows of samples are added to one strip before
/// they are added to the next strip. So the sums of a strip usually stay in the L1 cache.
constexpr int source_rows_per_group = 8;

constexpr std::size_t cache_line_floats = 16;

/// Number of float values in a SIMD vector. A row of 64 pixels is computed as 8 such vectors. These fit into
/// the registers, and 64 pixels are enough to keep the loop's overhead small.
constexpr int lanes = 8;
constexpr int vectors = RunScatter::strip_width / lanes;
// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef float Floats __attribute__((vector_size(lanes * sizeof(float))));
// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef float FloatsAnywhere __attribute__((vector_size(lanes * sizeof(float)), aligned(4), may_alias));
// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef double DoublesAnywhere __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

/// Arguments of filter_strip. This function blurs one row of samples with a disc-shaped kernel, and adds the
/// result to a strip of the image. The strip is 64 columns wide (RunScatter::strip_width).
struct StripFilter {
    const KernelRow* rows;  ///< kernel rows dy = 0, 1, ...
    const float* taps;
    const float* line;      ///< source colour at the strip's first pixel
    const double* running;  ///< sum of source colours before the strip, times the kernel's inner value
};

/// A range [begin, end) of rows of a blur kernel, counted from the kernel's centre. These are the rows that
/// reach pixels of the block, the rectangle of the image that is being computed.
struct RowRange {
    int begin, end;
};

/// Blurs a row of samples with a disc-shaped kernel, and adds the result to a strip of the image. As a disc
/// is symmetric, each kernel row is added twice: to an image row below the samples (`down`) and to one above
/// them (`up`).
POSTLENS_MULTIVERSION
void filter_strip(const StripFilter& f, float* down, RowRange down_rows, float* up, RowRange up_rows) {
    constexpr int width = RunScatter::strip_width;
    const int begin = down_rows.begin < up_rows.begin ? down_rows.begin : up_rows.begin;
    const int end = down_rows.end > up_rows.end ? down_rows.end : up_rows.end;
    Floats inside[vectors] = {};
    int inside_end = -1;
    for (int dy = begin; dy < end; ++dy) {
        const KernelRow& row = f.rows[dy];
        const bool has_inside = row.inner_begin != row.inner_end;
        const int pairs = has_inside ? row.inner_begin - row.x_begin : row.x_end;
        if (has_inside && row.inner_end != inside_end) {
            inside_end = row.inner_end;
            const double* high = f.running - row.inner_begin + 1;
            const double* low = f.running - row.inner_end + 1;
            for (int v = 0; v < vectors; ++v) {
                inside[v] =
                    __builtin_convertvector(*reinterpret_cast<const DoublesAnywhere*>(high + v * lanes) -
                                                *reinterpret_cast<const DoublesAnywhere*>(low + v * lanes),
                                            Floats);
            }
        }
        Floats sum[vectors];
        for (int v = 0; v < vectors; ++v) sum[v] = has_inside ? inside[v] : Floats{};
        const float* tap = f.taps + row.tap;
        const float* left = f.line - row.x_begin;
        const float* right = f.line - row.x_end + 1;
        for (int i = 0; i < pairs; ++i) {
            for (int v = 0; v < vectors; ++v) {
                sum[v] += tap[i] * (*reinterpret_cast<const FloatsAnywhere*>(left - i + v * lanes) +
                                    *reinterpret_cast<const FloatsAnywhere*>(right + i + v * lanes));
            }
        }
        if (dy >= down_rows.begin && dy < down_rows.end) {
            float* to = down + dy * width;
            for (int v = 0; v < vectors; ++v) *reinterpret_cast<FloatsAnywhere*>(to + v * lanes) += sum[v];
        }
        if (dy >= up_rows.begin && dy < up_rows.end) {
            float* to = up - dy * width;
            for (int v = 0; v < vectors; ++v) *reinterpret_cast<FloatsAnywhere*>(to + v * lanes) += sum[v];
        }
    }
}

POSTLENS_MULTIVERSION
void add_row_sums(const KernelRow* rows, float* down, RowRange down_rows, float* up, RowRange up_rows) {
    constexpr int width = RunScatter::strip_width;
    for (int dy = down_rows.begin; dy < down_rows.end; ++dy) {
        for (int i = 0; i < width; ++i) down[dy * width + i] += rows[dy].sum;
    }
    for (int dy = up_rows.begin; dy < up_rows.end; ++dy) {
        for (int i = 0; i < width; ++i) up[-dy * width + i] += rows[dy].sum;
    }
}

POSTLENS_MULTIVERSION
void add_and_clear(double* total, float* partial, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        total[i] += static_cast<double>(partial[i]);
        partial[i] = 0;
    }
}

POSTLENS_MULTIVERSION
void move_and_clear(double* total, float* partial, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        total[i] = static_cast<double>(partial[i]);
        partial[i] = 0;
    }
}

}  // namespace

struct RunScatter::LaidRun {
    const KernelRow* row_0;  ///< kernel row of dy = 0
    const float* taps;
    double inner;
    RowRange down, up;
    int y, strip_begin, strip_end;
    int full_begin, full_end;  ///< strips in which the run covers the whole kernel around every pixel
    int line_begin;            ///< column of the lines' first value
    int from, to;              ///< columns of the run within the lines
    std::array<const float*, 4> in_raster;
    std::array<std::size_t, 4> line_at, running_at;
};

RunScatter::RunScatter(const SplatTables& tables) : tables_(tables) {}
RunScatter::~RunScatter() = default;
RunScatter::RunScatter(RunScatter&&) noexcept = default;

void RunScatter::flush_rows(int begin, int end, bool fresh) {
    if (begin >= end) return;
    const std::size_t count = static_cast<std::size_t>(end - begin) * strip_width;
    for (int channel = 0; channel < 4; ++channel) {
        for (int strip = 0; strip < strips_; ++strip) {
            const std::size_t at = index(channel, strip, begin);
            (fresh ? move_and_clear : add_and_clear)(total_.data() + at, partial_.data() + at, count);
        }
    }
}

void RunScatter::flush() {
    // Adds the sums of the block's rows, which are in float, to `total_`, which is in double. From the row
    // `fresh_from_` on, `total_` contains no values yet, so the rows are overwritten. Rows that no sample has
    // reached thereby become 0.
    const int end = std::max(touched_end_, fresh_from_);
    flush_rows(touched_begin_, fresh_from_, false);
    flush_rows(fresh_from_, end, true);
    fresh_from_ = end;
    touched_begin_ = rows_;
    touched_end_ = 0;
}

bool RunScatter::run(const RasterWindow& block) {
    block_ = block;
    strips_ = (block.width() + strip_width - 1) / strip_width;
    rows_ = block.height();
    touched_begin_ = rows_;
    touched_end_ = fresh_from_ = 0;
    bool any = false;
    int rows_added = 0;
    const RasterWindow& source = tables_.source();
    const int last = std::min(source.y_end, block_.y_end - tables_.run_dy_begin());
    for (int y = std::max(source.y_begin, block_.y_begin - tables_.run_dy_end()); y < last; ++y) {
        const SplatRow& row = tables_.row(y);
        const int begin = std::max(y + row.run_dy_begin, block_.y_begin);
        const int end = std::min(y + row.run_dy_end, block_.y_end);
        if (row.runs.empty() || begin >= end) continue;
        if (partial_.size() < index(4, 0, 0)) {
            partial_.resize(index(4, 0, 0));
            total_.resize(partial_.size());
        }
        any = true;
        touched_begin_ = std::min(touched_begin_, begin - block_.y_begin);
        touched_end_ = std::max(touched_end_, end - block_.y_begin);
        for (const SplatRun& run : row.runs) lay_run(run, y);
        ++rows_added;
        if (rows_added % source_rows_per_group == 0) filter_laid_runs();
        if (rows_added % source_rows_per_flush == 0) flush();
    }
    if (!any) return false;
    filter_laid_runs();
    touched_end_ = rows_;
    flush();
    return true;
}

void RunScatter::lay_run(const SplatRun& run, int y) {
    const Kernel& kernel = tables_.kernels()[run.kernel];
    const int reach = kernel.x_end;
    const int rows = kernel.y_end();
    LaidRun laid{};
    // The kernel is a disc whose centre lies on a pixel corner. Its upper half mirrors its lower half, so the
    // rows -(1 + dy) and dy have the same values. Therefore, only the lower half is used, and `row_0` points
    // to its first row, dy = 0.
    laid.row_0 = kernel.rows.data() - kernel.y_begin;
    laid.taps = kernel.taps.data();
    laid.inner = static_cast<double>(kernel.inner);
    laid.y = y;
    laid.down = {std::clamp(block_.y_begin - y, 0, rows), std::clamp(block_.y_end - y, 0, rows)};
    laid.up = {std::clamp(y - block_.y_end, 0, rows), std::clamp(y - block_.y_begin, 0, rows)};
    const auto strip_of = [&](int x) { return floor_div(x - block_.x_begin, strip_width); };
    laid.strip_begin = std::max(0, strip_of(run.begin - reach));
    laid.strip_end = std::min(strips_, strip_of(run.end + reach - 1) + 1);
    if (laid.strip_begin >= laid.strip_end) return;
    if (laid.down.begin == laid.down.end && laid.up.begin == laid.up.end) return;
    laid.full_begin =
        std::clamp(strip_of(run.begin + reach + strip_width - 1), laid.strip_begin, laid.strip_end);
    laid.full_end = std::clamp(strip_of(run.end - reach), laid.full_begin, laid.strip_end);

    laid.line_begin = block_.x_begin + laid.strip_begin * strip_width - reach - 1;
    const int line_end = block_.x_begin + laid.strip_end * strip_width + reach + 1;
    laid.from = std::clamp(run.begin, laid.line_begin, line_end);
    laid.to = std::clamp(run.end, laid.line_begin, line_end);
    const bool all_full = laid.full_begin == laid.strip_begin && laid.full_end == laid.strip_end;
    const int channels = all_full ? 3 : 4;
    for (int channel = 0; channel < channels; ++channel) lay_line(laid, channel, line_end);
    if (laid.row_0->inner_begin != laid.row_0->inner_end) lay_running_sums(laid, channels, line_end);
    laid_.push_back(laid);
}

void RunScatter::lay_line(LaidRun& laid, int channel, int line_end) {
    const auto c = static_cast<std::size_t>(channel);
    const auto length = static_cast<std::size_t>(line_end - laid.line_begin);
    const auto before = static_cast<std::size_t>(laid.from - laid.line_begin);
    const auto inside = static_cast<std::size_t>(laid.to - laid.from);
    const float* source =
        channel < 3 ? tables_.raster_row(channel, laid.y) + (laid.from - tables_.source().x_begin) : nullptr;
    if (inside == length && source != nullptr) {
        laid.in_raster[c] = source;
        // Prefetches the samples, because they are later read in an order that defeats the hardware
        // prefetcher.
        for (std::size_t i = 0; i < length; i += cache_line_floats) __builtin_prefetch(source + i);
    } else {
        laid.line_at[c] = lines_used_;
        lines_used_ += length;
        if (lines_.size() < lines_used_) lines_.resize(2 * lines_used_);
        float* line = lines_.data() + laid.line_at[c];
        std::fill_n(line, before, 0.0F);
        if (source != nullptr) {
            std::copy_n(source, inside, line + before);
        } else {
            std::fill_n(line + before, inside, 1.0F);
        }
        std::fill_n(line + before + inside, length - before - inside, 0.0F);
    }
}

void RunScatter::lay_running_sums(LaidRun& laid, int channels, int line_end) {
    const auto length = static_cast<std::size_t>(line_end - laid.line_begin) + 1;
    const auto before = static_cast<std::size_t>(laid.from - laid.line_begin);
    const auto inside = static_cast<std::size_t>(laid.to - laid.from);
    const std::size_t begin = running_used_;
    running_used_ += 4 * length;
    if (running_.size() < running_used_) running_.resize(2 * running_used_);
    std::array<double*, 4> running{};
    std::array<const float*, 3> source{};
    for (std::size_t c = 0; c < 4; ++c) {
        laid.running_at[c] = begin + c * length;
        std::fill_n(running_.data() + laid.running_at[c], before, 0.0);
        running[c] = running_.data() + laid.running_at[c] + before;
        if (c < 3)
            source[c] =
                tables_.raster_row(static_cast<int>(c), laid.y) + (laid.from - tables_.source().x_begin);
    }
    // Interleaving three independent chains of additions hides their latency.
    double r = 0, g = 0, b = 0;
    for (std::size_t i = 0; i < inside; ++i) {
        running[0][i] = r;
        running[1][i] = g;
        running[2][i] = b;
        r += laid.inner * static_cast<double>(source[0][i]);
        g += laid.inner * static_cast<double>(source[1][i]);
        b += laid.inner * static_cast<double>(source[2][i]);
    }
    const std::size_t after = length - before - inside;
    std::fill_n(running[0] + inside, after, r);
    std::fill_n(running[1] + inside, after, g);
    std::fill_n(running[2] + inside, after, b);
    if (channels < 4) return;
    for (std::size_t i = 0; i < inside; ++i) running[3][i] = laid.inner * static_cast<double>(i);
    std::fill_n(running[3] + inside, after, laid.inner * static_cast<double>(inside));
}

void RunScatter::filter_laid_runs() {
    for (int channel = 0; channel < 4; ++channel) {
        const auto c = static_cast<std::size_t>(channel);
        for (int strip = 0; strip < strips_; ++strip) {
            for (const LaidRun& laid : laid_) {
                if (strip < laid.strip_begin || strip >= laid.strip_end) continue;
                float* down =
                    partial_.data() + index(channel, strip, 0) + (laid.y - block_.y_begin) * strip_width;
                float* up = down - strip_width;
                if (channel == 3 && strip >= laid.full_begin && strip < laid.full_end) {
                    add_row_sums(laid.row_0, down, laid.down, up, laid.up);
                    continue;
                }
                const auto offset =
                    static_cast<std::size_t>(block_.x_begin + strip * strip_width - laid.line_begin);
                const float* line =
                    laid.in_raster[c] != nullptr ? laid.in_raster[c] : lines_.data() + laid.line_at[c];
                filter_strip({.rows = laid.row_0,
                              .taps = laid.taps,
                              .line = line + offset,
                              .running = running_.data() + laid.running_at[c] + offset},
                             down, laid.down, up, laid.up);
            }
        }
    }
    laid_.clear();
    lines_used_ = running_used_ = 0;
}

}  // namespace postlens
