#include "motionblur/convolution/direct_convolution.h"

#include <algorithm>
#include <cmath>

#include "core/memory.h"
#include "core/multiversion.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Number of adjacent pixels in a row of the result that are computed at once, each as a sum. The 64 sums are
/// floats, and fill eight of AVX2's sixteen vector registers, with 8 floats each.
constexpr int tile = 64;
constexpr int lanes = 8;
constexpr int vectors = tile / lanes;
/// A pixel of the result is a sum of products (value times weight). Groups of up to this number of products
/// are summed as floats, and the sum of a group is then added to a double. The conversion of the weight to
/// float, the product and up to 32 additions each have a relative rounding error of at most 2^-24. So the
/// error of a group is below 34 * 2^-24 of the sum of its products' absolute values.
constexpr std::size_t terms_per_flush = 32;
/// A run is a sequence of equal neighbouring weights of the blur kernel, which can be applied at once.
/// `run_cost` is the time for this, divided by the time to apply a single weight. Therefore, sequences of up
/// to `run_cost` weights are applied weight by weight.
constexpr int run_cost = 6;
/// Relative difference up to which two weights of the blur kernel count as equal. Rounding makes equal
/// weights differ slightly.
constexpr double equal_weights = 1e-9;

// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef float Floats __attribute__((vector_size(lanes * sizeof(float))));
// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef float FloatsAnywhere __attribute__((vector_size(lanes * sizeof(float)), aligned(4), may_alias));
// NOLINTNEXTLINE(modernize-use-using): an alias declaration would lose the attributes
typedef double Doubles __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

/// A run of equal weights in row y of the blur kernel (the rasterised motion path): columns [begin, end).
struct PathRun {
    int y, begin, end;
    double weight;
};

/// The blur kernel (the rasterised motion path). Equal adjacent weights of a row are joined to one run.
struct PathRuns {
    std::vector<PathRun> runs;
    double cost = 0;  ///< predicted time of the convolution, in multiples of the time for one weight
    bool any_long = false;
};

bool is_long(const PathRun& run) {
    return run.end - run.begin > run_cost;
}

/// Divides the window into runs of equal weight along its rows.
template <typename Weight>
PathRuns runs_of(const CellWindow& window, const Weight& weight) {
    PathRuns out;
    for (int y = window.y_begin; y < window.y_end; ++y) {
        for (int x = window.x_begin; x < window.x_end;) {
            const double first = weight(x, y);
            if (first == 0) {
                ++x;
                continue;
            }
            int end = x + 1;
            double sum = first;
            while (end < window.x_end && std::abs(weight(end, y) - first) <= equal_weights * std::abs(first))
                sum += weight(end++, y);
            if (end - x > run_cost) {
                out.runs.push_back({y, x, end, sum / (end - x)});
                out.cost += run_cost;
                out.any_long = true;
            } else {
                end = x + 1;
                out.runs.push_back({y, x, end, first});
                out.cost += 1;
            }
            x = end;
        }
    }
    return out;
}

CellWindow transposed(const CellWindow& w) {
    return {w.y_begin, w.y_end, w.x_begin, w.x_end};
}

struct Orientation {
    PathRuns runs;
    bool is_transposed = false;
};

Orientation orient(const ConvolutionTask& task) {
    Orientation as_is{runs_of(task.path, [&](int x, int y) { return task.i2.at(x, y); }), false};
    Orientation turned{runs_of(transposed(task.path), [&](int x, int y) { return task.i2.at(y, x); }), true};
    // If the columns of the blur kernel contain longer runs of equal weights than its rows, image and kernel
    // are transposed for the convolution, and the result is transposed back. `turning` is the time that this
    // takes, in units of the time to apply one weight.
    constexpr double turning = 12;
    return turned.runs.cost + turning < as_is.runs.cost ? turned : as_is;
}

/// Transposes the cells of `from` that lie in `window`: copies the value in column x and row y to column y
/// and row x of `to`. This is done for each plane (colour channel or coverage).
void transpose(const Planes& from, const CellWindow& window, Planes& to) {
    constexpr int block = 32;  // cells along a side, so that both blocks stay in the cache
    const int bands = (window.height() + block - 1) / block;
    parallel_for(static_cast<std::size_t>(bands) * from.planes.size(), [&](std::size_t task) {
        const std::size_t plane = task / static_cast<std::size_t>(bands);
        const int y0 = window.y_begin + static_cast<int>(task % static_cast<std::size_t>(bands)) * block;
        const int y1 = std::min(y0 + block, window.y_end);
        const std::ptrdiff_t from_width = from.width, to_width = to.width;
        const float* source = from.planes[plane].data() - from.y_begin * from_width - from.x_begin;
        float* target = to.planes[plane].data() - to.y_begin * to_width - to.x_begin;
        for (int x0 = window.x_begin; x0 < window.x_end; x0 += block) {
            const int x1 = std::min(x0 + block, window.x_end);
            for (int x = x0; x < x1; ++x)
                for (int y = y0; y < y1; ++y) target[x * to_width + y] = source[y * from_width + x];
        }
    });
}

/// One weight of the blur kernel. It multiplies the value at the memory offset `at` from the computed pixel.
struct CellTerm {
    std::ptrdiff_t at;
    float weight;
};
/// A run: equal neighbouring weights in a row of the blur kernel. It adds weight * (sum[high] - sum[low]) to
/// a pixel of the result, where `sum` contains the prefix sums of a row of the image.
struct RunTerm {
    /// Memory offsets from the result's pixel to the prefix sums at the two ends of the run.
    std::ptrdiff_t high, low;
    double weight;
};
struct Terms {
    std::vector<CellTerm> cells;
    std::vector<RunTerm> runs;
};
/// A row of the blur kernel. `columns` is the range of its nonzero weights. Its runs of equal weights are the
/// elements Terms::runs [runs_begin, runs_end). All other weights are the elements Terms::cells [cells_begin,
/// cells_end).
struct PathRow {
    int y;
    ColumnRange columns;
    std::size_t cells_begin, cells_end, runs_begin, runs_end;
};

POSTLENS_MULTIVERSION
void add_cells(const float* plane, std::ptrdiff_t at, const CellTerm* terms, std::size_t count,
               double* sums) {
    for (std::size_t begin = 0; begin < count; begin += terms_per_flush) {
        const std::size_t end = begin + terms_per_flush < count ? begin + terms_per_flush : count;
        Floats partial[vectors] = {};
        for (std::size_t t = begin; t < end; ++t) {
            const float* from = plane + (at + terms[t].at);
            for (int v = 0; v < vectors; ++v)
                partial[v] += terms[t].weight * *reinterpret_cast<const FloatsAnywhere*>(from + v * lanes);
        }
        for (int v = 0; v < vectors; ++v)
            *reinterpret_cast<Doubles*>(sums + v * lanes) += __builtin_convertvector(partial[v], Doubles);
    }
}

POSTLENS_MULTIVERSION
void add_runs(const double* running, std::ptrdiff_t at, const RunTerm* terms, std::size_t count,
              double* sums) {
    for (std::size_t t = 0; t < count; ++t) {
        const double* high = running + (at + terms[t].high);
        const double* low = running + (at + terms[t].low);
        const double weight = terms[t].weight;
        for (int i = 0; i < tile; ++i) sums[i] += weight * (high[i] - low[i]);
    }
}

/// Convolves the image of a moving object as a sum over the weights of the blur kernel, without an FFT.
/// `tile` adjacent pixels in a row of the result are computed at once. They may need values beyond the ends
/// of a row of the image, so these rows are padded with zeros.
class DirectConvolution {
  public:
    DirectConvolution(const ConvolutionTask& task, PathRuns runs)
        : task_(task), runs_(std::move(runs)), source_(task.source), path_(task.path), out_(task.out) {
        const int tiles = (out_.width() + tile - 1) / tile;
        begin_ = std::min(source_.x_begin, out_.x_begin - path_.x_end);
        const int end = std::max(source_.x_end, out_.x_begin + tiles * tile - path_.x_begin);
        stride_ = static_cast<std::size_t>(end - begin_) + 1;
        const std::size_t cells = stride_ * static_cast<std::size_t>(source_.height());
        require_memory(
            task.i1.planes.size() * cells * (sizeof(float) + (runs_.any_long ? sizeof(double) : 0)),
            "convolution with a path");
        lay_rows(cells);
        lay_terms();
    }

    void run(Planes& result) const {
        // The result, the blurred image, is divided into blocks of 64 x 64 pixels, which several threads
        // compute in parallel. A task of parallel_for computes the rows of one block. Adjacent rows need
        // mostly the same rows of the image that is blurred, so these rows stay in the cache.
        constexpr int band = 64;
        const auto strips = static_cast<std::size_t>((out_.width() + tile - 1) / tile);
        const auto bands = static_cast<std::size_t>((out_.height() + band - 1) / band);
        parallel_for(strips * bands, [&](std::size_t i) {
            const int x = out_.x_begin + static_cast<int>(i / bands) * tile;
            const int y = out_.y_begin + static_cast<int>(i % bands) * band;
            Terms terms;
            for (int row = y; row < std::min(y + band, out_.y_end); ++row) run_tile(x, row, terms, result);
        });
    }

  private:
    void lay_rows(std::size_t cells) {
        const std::size_t planes = task_.i1.planes.size(),
                          height = static_cast<std::size_t>(source_.height());
        values_.resize(planes);
        running_.resize(planes);
        parallel_for(planes, [&](std::size_t p) {
            values_[p].resize(cells);
            if (runs_.any_long) running_[p].resize(cells);
        });
        parallel_for(height, [&](std::size_t r) {
            const int y = source_.y_begin + static_cast<int>(r);
            const ColumnRange c = task_.columns(y);
            if (c.is_empty()) return;
            for (std::size_t p = 0; p < planes; ++p) {
                std::copy(task_.row(p, y) + c.begin, task_.row(p, y) + c.end,
                          values_[p].data() + r * stride_ + (c.begin - begin_));
                if (!runs_.any_long) continue;
                // `running[i]` becomes the sum of the row's values before index i.
                const float* from = values_[p].data() + r * stride_;
                double* running = running_[p].data() + r * stride_;
                double sum = 0;
                for (std::size_t i = 0; i < stride_; ++i) {
                    running[i] = sum;
                    sum += static_cast<double>(from[i]);
                }
            }
        });
    }

    void lay_terms() {
        const auto stride = static_cast<std::ptrdiff_t>(stride_);
        for (const PathRun& run : runs_.runs) {
            const std::ptrdiff_t row = -run.y * stride;
            if (path_rows_.empty() || path_rows_.back().y != run.y)
                path_rows_.push_back(
                    {run.y, {run.begin, run.end}, all_.cells.size(), 0, all_.runs.size(), 0});
            if (is_long(run)) {
                all_.runs.push_back({row - run.begin + 1, row - run.end + 1, run.weight});
            } else {
                all_.cells.push_back({row - run.begin, static_cast<float>(run.weight)});
            }
            PathRow& path_row = path_rows_.back();
            path_row.columns.end = run.end;
            path_row.cells_end = all_.cells.size();
            path_row.runs_end = all_.runs.size();
        }
    }

    void run_tile(int x, int y, Terms& terms, Planes& result) const {
        terms.cells.clear();
        terms.runs.clear();
        for (const PathRow& row : path_rows_) {
            const int from = y - row.y;
            if (from < source_.y_begin) break;
            if (from >= source_.y_end) continue;
            const ColumnRange c = task_.columns(from);
            // Skips this row of the blur kernel if it adds nothing to the `tile` columns of the result from x
            // on. The row shifts a row of the object's image, whose nonzero values lie in the columns `c`, to
            // the right by the numbers in the range row.columns.
            if (x - row.columns.end + 1 >= c.end || x + tile - row.columns.begin <= c.begin) continue;
            const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
            terms.cells.insert(terms.cells.end(), all_.cells.begin() + at(row.cells_begin),
                               all_.cells.begin() + at(row.cells_end));
            terms.runs.insert(terms.runs.end(), all_.runs.begin() + at(row.runs_begin),
                              all_.runs.begin() + at(row.runs_end));
        }
        if (terms.cells.empty() && terms.runs.empty()) return;
        const std::ptrdiff_t at =
            static_cast<std::ptrdiff_t>(y - source_.y_begin) * static_cast<std::ptrdiff_t>(stride_) +
            (x - begin_);
        for (std::size_t p = 0; p < values_.size(); ++p) {
            alignas(64) double sums[tile] = {};
            add_cells(values_[p].data(), at, terms.cells.data(), terms.cells.size(), sums);
            if (!terms.runs.empty())
                add_runs(running_[p].data(), at, terms.runs.data(), terms.runs.size(), sums);
            write(result, p, x, y, sums);
        }
    }

    void write(Planes& result, std::size_t plane, int x, int y, const double* sums) const {
        const int count = std::min(tile, out_.x_end - x);
        const auto width = static_cast<std::ptrdiff_t>(result.width);
        float* to = result.planes[plane].data() + (y - result.y_begin) * width + (x - result.x_begin);
        for (int i = 0; i < count; ++i) to[i] = static_cast<float>(sums[i]);
    }

    const ConvolutionTask& task_;
    PathRuns runs_;
    CellWindow source_, path_, out_;
    int begin_ = 0;  ///< column of the first value of a padded row
    std::size_t stride_ = 0;
    Terms all_;
    std::vector<PathRow> path_rows_;
    std::vector<std::vector<float>> values_;
    std::vector<std::vector<double>> running_;
};

}  // namespace

void convolve_direct(const ConvolutionTask& task, Planes& result) {
    if (task.is_empty()) return;
    Orientation chosen = orient(task);
    if (!chosen.is_transposed) {
        DirectConvolution(task, std::move(chosen.runs)).run(result);
        return;
    }
    Planes i1 = zero_planes(transposed(task.source), result.planes.size());
    transpose(task.i1, task.source, i1);
    PathRaster i2{task.path.y_begin, task.path.x_begin,    task.path.height(),
                  task.path.width(), task.i2.cells_per_px, {}};
    for (int x = task.path.x_begin; x < task.path.x_end; ++x)
        for (int y = task.path.y_begin; y < task.path.y_end; ++y) i2.weight.push_back(task.i2.at(x, y));
    const ConvolutionTask turned(i1, i2, transposed(task.out));
    Planes turned_result = zero_planes(turned.out, result.planes.size());
    DirectConvolution(turned, std::move(chosen.runs)).run(turned_result);
    transpose(turned_result, turned.out, result);
}

double direct_cost_s(const ConvolutionTask& task) {
    if (task.is_empty()) return 0;
    const Orientation chosen = orient(task);
    double area = 0;
    for (const ColumnRange& c : task.rows) area += c.is_empty() ? 0 : c.end - c.begin + tile;
    const auto planes = static_cast<double>(task.i1.planes.size());
    // Fraction of the full convolution's result that is computed.
    const CellWindow full = full_window(task.source, task.path);
    const double share = 1.0 * task.out.width() / full.width() * task.out.height() / full.height();
    // Predicts the time of a convolution from constants, in s, measured with the benchmark
    // `one_object/direct`. A value is a pixel in one channel. `s_per_cell` is the time to multiply a value by
    // one weight of the blur kernel and add it.
    constexpr double s_per_cell = 1.3e-10, large_values = 500'000;
    // Time to copy a value when the image is padded with zeros. Above `large_values` values, copying is
    // slower, because the operating system must then provide new memory pages.
    const double s_per_copy = planes * area > large_values ? 12e-9 : 4e-9;
    const double s_per_sum = 2 * s_per_copy;
    double cost_s = planes * area * (share * chosen.runs.cost * s_per_cell + s_per_copy);
    if (chosen.runs.any_long) {
        const CellWindow path = chosen.is_transposed ? transposed(task.path) : task.path;
        const CellWindow source = chosen.is_transposed ? transposed(task.source) : task.source;
        cost_s += planes * source.height() * (source.width() + path.width()) * s_per_sum;
    }
    return cost_s;
}

}  // namespace postlens
