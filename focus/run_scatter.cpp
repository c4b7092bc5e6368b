#include "focus/run_scatter.h"

#include <algorithm>

#include "core/multiversion.h"

namespace postlens {
namespace {

/// Float sums hold this many source rows before they go to double: rounding stays below 1e-6 of the sum.
constexpr int source_rows_per_flush = 32;

/// Four vectors of eight make a strip: few enough for registers, enough to hide the loop around them.
constexpr int lanes = 8;
constexpr int vectors = RunScatter::strip_width / lanes;
typedef float Floats __attribute__((vector_size(lanes * sizeof(float))));
typedef float FloatsAnywhere __attribute__((vector_size(lanes * sizeof(float)), aligned(4), may_alias));
typedef double DoublesAnywhere __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

/// What filter_strip needs besides where it writes.
struct StripFilter {
    const KernelRow* rows;  ///< of dy = 0, 1, ...
    const float* taps;
    double inner;
    const float* line;      ///< source colour at the strip's first pixel
    const double* running;  ///< sum of source colours before the strip's first pixel
};

/// Source rows above and below that get the same: dy in [begin, end) with a place to write.
struct RowRange {
    int begin, end;
};

/// Adds the source row, filtered by kernel row dy, to `down` + dy rows and to `up` - dy rows.
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
                const DoublesAnywhere sum = *reinterpret_cast<const DoublesAnywhere*>(high + v * lanes) -
                                            *reinterpret_cast<const DoublesAnywhere*>(low + v * lanes);
                inside[v] = __builtin_convertvector(sum * f.inner, Floats);
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

/// The same where all that a kernel row reaches is one: its sum.
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

int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

}  // namespace

/// Where a run's line lies: it covers whatever the strips may look at.
struct RunScatter::Line {
    int begin, end;       ///< columns
    int from, to;         ///< those of the run
    bool needs_running;   ///< its kernel has an inside
    [[nodiscard]] std::size_t length() const { return static_cast<std::size_t>(end - begin); }
    [[nodiscard]] std::size_t before() const { return static_cast<std::size_t>(from - begin); }
    [[nodiscard]] std::size_t inside() const { return static_cast<std::size_t>(to - from); }
};

RunScatter::RunScatter(const SplatTables& tables, const RasterWindow& block)
    : tables_(tables),
      block_(block),
      strips_((block.width() + strip_width - 1) / strip_width),
      rows_(block.height()),
      touched_begin_(rows_),
      touched_end_(0) {}

void RunScatter::flush() {
    if (touched_begin_ >= touched_end_) return;
    const std::size_t count = static_cast<std::size_t>(touched_end_ - touched_begin_) * strip_width;
    for (int channel = 0; channel < 4; ++channel) {
        for (int strip = 0; strip < strips_; ++strip) {
            const std::size_t at = index(channel, strip, touched_begin_);
            add_and_clear(total_.data() + at, partial_.data() + at, count);
        }
    }
    touched_begin_ = rows_;
    touched_end_ = 0;
}

bool RunScatter::run() {
    int rows_added = 0;
    const RasterWindow& source = tables_.source();
    for (int y = source.y_begin; y < source.y_end; ++y) {
        const SplatRow& row = tables_.row(y);
        const int begin = std::max(y + row.run_dy_begin, block_.y_begin);
        const int end = std::min(y + row.run_dy_end, block_.y_end);
        if (row.runs.empty() || begin >= end) continue;
        if (partial_.empty()) {
            partial_.resize(index(4, 0, 0));
            total_.resize(partial_.size());
        }
        touched_begin_ = std::min(touched_begin_, begin - block_.y_begin);
        touched_end_ = std::max(touched_end_, end - block_.y_begin);
        for (const SplatRun& run : row.runs) add_run(run, y);
        if (++rows_added == source_rows_per_flush) {
            flush();
            rows_added = 0;
        }
    }
    flush();
    return !partial_.empty();
}

void RunScatter::lay_colours(const Line& line, int y) {
    const std::size_t length = line.length(), before = line.before(), inside = line.inside();
    std::array<const float*, 3> source{};
    for (std::size_t c = 0; c < 3; ++c) {
        source[c] = tables_.raster_row(static_cast<int>(c), y) + (line.from - tables_.source().x_begin);
        if (line_[c].size() < length) line_[c].resize(length);
        float* to = line_[c].data();
        std::fill_n(to, before, 0.0F);
        std::copy_n(source[c], inside, to + before);
        std::fill_n(to + before + inside, length - before - inside, 0.0F);
    }
    if (!line.needs_running) return;
    std::array<double*, 3> running{};
    for (std::size_t c = 0; c < 3; ++c) {
        if (running_[c].size() < length + 1) running_[c].resize(length + 1);
        std::fill_n(running_[c].data(), before, 0.0);
        running[c] = running_[c].data() + before;
    }
    // Three chains of additions at once: each alone would wait for itself.
    double r = 0, g = 0, b = 0;
    for (std::size_t i = 0; i < inside; ++i) {
        running[0][i] = r;
        running[1][i] = g;
        running[2][i] = b;
        r += static_cast<double>(source[0][i]);
        g += static_cast<double>(source[1][i]);
        b += static_cast<double>(source[2][i]);
    }
    const std::size_t rest = length + 1 - before - inside;
    std::fill_n(running[0] + inside, rest, r);
    std::fill_n(running[1] + inside, rest, g);
    std::fill_n(running[2] + inside, rest, b);
}

void RunScatter::lay_ones(const Line& line) {
    const std::size_t length = line.length(), before = line.before(), inside = line.inside();
    line_[3].assign(length, 0.0F);
    std::fill_n(line_[3].data() + before, inside, 1.0F);
    if (!line.needs_running) return;
    running_[3].assign(length + 1, 0.0);
    for (std::size_t i = before; i < length + 1; ++i) {
        running_[3][i] = static_cast<double>(std::min(i - before, inside));
    }
}

void RunScatter::add_run(const SplatRun& run, int y) {
    const Kernel& kernel = tables_.kernels()[run.kernel];
    const int reach = kernel.x_end;
    const int strip_begin = std::max(0, floor_div(run.begin - reach - block_.x_begin, strip_width));
    const int strip_end = std::min(strips_, floor_div(run.end + reach - 1 - block_.x_begin, strip_width) + 1);
    // Kernel rows by dy >= 0; row -1 - dy is the same.
    const int rows = kernel.y_end();
    const RowRange down{std::clamp(block_.y_begin - y, 0, rows), std::clamp(block_.y_end - y, 0, rows)};
    const RowRange up{std::clamp(y - block_.y_end, 0, rows), std::clamp(y - block_.y_begin, 0, rows)};
    if ((down.begin == down.end && up.begin == up.end) || strip_begin >= strip_end) return;

    const KernelRow* row_0 = kernel.rows.data() - kernel.y_begin;
    Line line{.begin = block_.x_begin + strip_begin * strip_width - reach - 1,
              .end = block_.x_begin + strip_end * strip_width + reach + 1,
              .from = 0,
              .to = 0,
              .needs_running = row_0->inner_begin != row_0->inner_end};
    line.from = std::clamp(run.begin, line.begin, line.end);
    line.to = std::clamp(run.end, line.begin, line.end);
    lay_colours(line, y);
    StripFilter f{.rows = row_0,
                  .taps = kernel.taps.data(),
                  .inner = static_cast<double>(kernel.inner),
                  .line = nullptr,
                  .running = nullptr};
    const auto filter = [&](std::size_t channel, int strip, float* down_to) {
        const auto offset = static_cast<std::size_t>(block_.x_begin + strip * strip_width - line.begin);
        f.line = line_[channel].data() + offset;
        f.running = line.needs_running ? running_[channel].data() + offset : nullptr;
        filter_strip(f, down_to, down, down_to - strip_width, up);
    };
    const auto place = [&](int channel, int strip) {
        return partial_.data() + index(channel, strip, 0) + (y - block_.y_begin) * strip_width;
    };
    for (int channel = 0; channel < 3; ++channel) {
        for (int strip = strip_begin; strip < strip_end; ++strip) {
            filter(static_cast<std::size_t>(channel), strip, place(channel, strip));
        }
    }
    bool ones_laid = false;
    for (int strip = strip_begin; strip < strip_end; ++strip) {
        const int x = block_.x_begin + strip * strip_width;
        float* down_to = place(3, strip);
        if (run.begin <= x - reach && run.end >= x + strip_width + reach) {
            add_row_sums(row_0, down_to, down, down_to - strip_width, up);
            continue;
        }
        if (!ones_laid) lay_ones(line);
        ones_laid = true;
        filter(3, strip, down_to);
    }
}

}  // namespace postlens
