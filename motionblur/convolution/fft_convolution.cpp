#include "motionblur/convolution/fft_convolution.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fftw3.h>
#include <limits>
#include <memory>
#include <mutex>
#include <new>

#include "core/memory.h"
#include "core/multiversion.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Divides one axis of the convolution's result into `count` blocks of at most `length` values. The FFT of a
/// block has `size` points, including padding.
struct AxisBlocks {
    int count = 1, length = 0, size = 0;
};

/// Index ranges of a convolution along one axis (x or y): [s0, s1) of the image that is blurred, [p0, p1) of
/// the blur kernel, and [o0, o1) of the result.
struct Axis {
    int s0, s1, p0, p1, o0, o1;
};

/// Returns the smallest FFT size with which a convolution along one axis is correct at the indices [x0, x1)
/// of the result. An FFT treats its values as periodic. So with a smaller size, other values of the result
/// would be added to those in [x0, x1).
int needed_size(const Axis& axis, int x0, int x1) {
    // [p0, p1) are the indices of the blur kernel along the axis, and [s0, s1) those of the object's image.
    // Only the indices [a, b) of the image contribute to the results [x0, x1). If this range is empty, these
    // results are 0 with any FFT size.
    const int a = std::max(axis.s0, x0 - axis.p1 + 1), b = std::min(axis.s1, x1 - axis.p0);
    if (a >= b) return 1;
    return std::max({b + axis.p1 - 1 - x0, x1 - a - axis.p0, x1 - x0, b - a, axis.p1 - axis.p0});
}

AxisBlocks blocks(const Axis& axis, int count) {
    AxisBlocks out;
    out.length = (axis.o1 - axis.o0 + count - 1) / count;
    out.count = (axis.o1 - axis.o0 + out.length - 1) / out.length;
    int size = 1;
    for (int i = 0; i < out.count; ++i) {
        const int x0 = axis.o0 + i * out.length;
        size = std::max(size, needed_size(axis, x0, std::min(x0 + out.length, axis.o1)));
    }
    // FFT sizes that are multiples of 8 are fastest, because rows then consist of whole SIMD vectors. Other
    // sizes can take twice as long.
    constexpr int vector = 8;
    out.size = vector * fast_fft_size((size + vector - 1) / vector);
    return out;
}

struct Tiling {
    AxisBlocks x, y;
    double cost_s = std::numeric_limits<double>::infinity();
};

double transform_cost_s(double cells) {
    // Time of an FFT of n cells per n log2(n), in seconds, measured with the benchmark `one_object/fft`.
    constexpr double s_per_step = 3.3e-10;
    return s_per_step * cells * std::max(1.0, std::log2(cells));
}

Tiling best_tiling(const ConvolutionTask& task) {
    const CellWindow &s = task.source, &p = task.path, &o = task.out;
    const Axis along_x{s.x_begin, s.x_end, p.x_begin, p.x_end, o.x_begin, o.x_end};
    const Axis along_y{s.y_begin, s.y_end, p.y_begin, p.y_end, o.y_begin, o.y_end};
    const auto planes = static_cast<double>(task.i1.planes.size());
    constexpr int counts[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
    Tiling best;
    for (const int ny : counts) {
        const AxisBlocks y = blocks(along_y, ny);
        for (const int nx : counts) {
            const AxisBlocks x = blocks(along_x, nx);
            const double cells = static_cast<double>(x.size) * y.size;
            const double transforms = 1 + 2 * planes * x.count * y.count;
            constexpr double plans_s = 1e-4;
            const double cost_s = plans_s + transforms * transform_cost_s(cells);
            if (cost_s < best.cost_s) best = {x, y, cost_s};
        }
    }
    return best;
}

struct Free {
    void operator()(void* p) const { fftwf_free(p); }
};

/// Allocates an array with FFTW's alignment, because a plan applies only to arrays of equal alignment.
template <typename T>
std::unique_ptr<T[], Free> allocate(std::size_t count) {
    auto* p = static_cast<T*>(fftwf_malloc(count * sizeof(T)));
    if (p == nullptr) throw std::bad_alloc();
    return std::unique_ptr<T[], Free>(p);
}

/// Arrays in which one thread computes transforms.
struct Buffers {
    std::unique_ptr<float[], Free> cells;
    std::unique_ptr<std::complex<float>[], Free> spectrum;
};

fftwf_complex* raw(std::complex<float>* p) {
    return reinterpret_cast<fftwf_complex*>(p);
}

/// Computes a *= b for complex numbers. Real and imaginary parts have separate loops: in one loop, GCC 12
/// would use fused multiply-adds, and results would depend on the processor.
POSTLENS_MULTIVERSION
void multiply(float* __restrict a, const float* __restrict b, std::size_t count) {
    constexpr std::size_t block = 64;
    float re[block], im[block];
    for (std::size_t begin = 0; begin < count; begin += block) {
        const std::size_t n = count - begin < block ? count - begin : block;
        float* __restrict x = a + 2 * begin;
        const float* __restrict y = b + 2 * begin;
        for (std::size_t i = 0; i < n; ++i) re[i] = x[2 * i] * y[2 * i] - x[2 * i + 1] * y[2 * i + 1];
        for (std::size_t i = 0; i < n; ++i) im[i] = x[2 * i] * y[2 * i + 1] + x[2 * i + 1] * y[2 * i];
        for (std::size_t i = 0; i < n; ++i) {
            x[2 * i] = re[i];
            x[2 * i + 1] = im[i];
        }
    }
}

/// Returns the smallest value, or 0 if all are positive.
POSTLENS_MULTIVERSION
float least_of(const float* values, std::size_t count) {
    float least = 0;
    for (std::size_t i = 0; i < count; ++i) least = values[i] < least ? values[i] : least;
    return least;
}

class FftConvolution {
  public:
    FftConvolution(const ConvolutionTask& task, const Tiling& tiling)
        : task_(task), x_(tiling.x), y_(tiling.y) {
        width_ = static_cast<std::size_t>(x_.size);
        height_ = static_cast<std::size_t>(y_.size);
        spectrum_width_ = width_ / 2 + 1;
        const std::size_t tasks =
            task.i1.planes.size() * static_cast<std::size_t>(x_.count) * static_cast<std::size_t>(y_.count);
        const std::size_t at_once = std::min(static_cast<std::size_t>(thread_count()), tasks) + 1;
        require_memory(at_once * height_ * (width_ + 2 * spectrum_width_) * sizeof(float),
                       "convolution with a path");
        Buffers first = make_buffers();
        {
            const std::lock_guard lock(planner());
            // FFTW_ESTIMATE chooses the same plans in every run. With measured plans, the last bits of the
            // results may differ.
            forward_ = fftwf_plan_dft_r2c_2d(y_.size, x_.size, first.cells.get(), raw(first.spectrum.get()),
                                             FFTW_ESTIMATE);
            backward_ = fftwf_plan_dft_c2r_2d(y_.size, x_.size, raw(first.spectrum.get()), first.cells.get(),
                                              FFTW_ESTIMATE);
        }
        if (forward_ == nullptr || backward_ == nullptr) throw std::bad_alloc();
        transform_path(first);
        lay_reach();
    }
    ~FftConvolution() {
        const std::lock_guard lock(planner());
        if (forward_ != nullptr) fftwf_destroy_plan(forward_);
        if (backward_ != nullptr) fftwf_destroy_plan(backward_);
    }
    FftConvolution(const FftConvolution&) = delete;
    FftConvolution& operator=(const FftConvolution&) = delete;
    FftConvolution(FftConvolution&&) = delete;
    FftConvolution& operator=(FftConvolution&&) = delete;

    void run(Planes& result) {
        const auto per_plane = static_cast<std::size_t>(x_.count) * static_cast<std::size_t>(y_.count);
        parallel_for(per_plane * result.planes.size(), [&](std::size_t i) {
            const int block = static_cast<int>(i % per_plane);
            Buffers buffers = take_buffers();
            run_block(i / per_plane, block % x_.count, block / x_.count, buffers, result);
            give_back(std::move(buffers));
        });
    }

  private:
    /// Only one thread may create or destroy FFTW plans at a time.
    static std::mutex& planner() {
        static std::mutex mutex;
        return mutex;
    }

    Buffers make_buffers() const {
        return {allocate<float>(width_ * height_), allocate<std::complex<float>>(spectrum_width_ * height_)};
    }
    Buffers take_buffers() {
        {
            const std::lock_guard lock(spare_mutex_);
            if (!spare_.empty()) {
                Buffers out = std::move(spare_.back());
                spare_.pop_back();
                return out;
            }
        }
        return make_buffers();
    }
    void give_back(Buffers buffers) {
        const std::lock_guard lock(spare_mutex_);
        spare_.push_back(std::move(buffers));
    }

    static std::size_t wrapped(int i, int size) {
        return static_cast<std::size_t>(((i % size) + size) % size);
    }

    /// Computes the FFT of the blur kernel (the rasterised motion path), including the FFT's normalisation.
    void transform_path(Buffers& buffers) {
        float* cells = buffers.cells.get();
        std::fill_n(cells, width_ * height_, 0.0F);
        const double scale = 1 / (static_cast<double>(width_) * static_cast<double>(height_));
        for (int y = task_.path.y_begin; y < task_.path.y_end; ++y)
            for (int x = task_.path.x_begin; x < task_.path.x_end; ++x)
                cells[wrapped(y, y_.size) * width_ + wrapped(x, x_.size)] =
                    static_cast<float>(scale * task_.i2.at(x, y));
        fftwf_execute_dft_r2c(forward_, cells, raw(buffers.spectrum.get()));
        path_ = std::move(buffers.spectrum);
    }

    /// For each row of the blurred image, finds the range of columns that may contain nonzero values. The
    /// range follows from the nonzero columns in the rows of the image and of the blur kernel.
    void lay_reach() {
        std::vector<ColumnRange> path_rows;
        for (int y = task_.path.y_begin; y < task_.path.y_end; ++y) {
            ColumnRange c{task_.path.x_begin, task_.path.x_end};
            while (c.begin < c.end && task_.i2.at(c.begin, y) == 0) ++c.begin;
            while (c.begin < c.end && task_.i2.at(c.end - 1, y) == 0) --c.end;
            path_rows.push_back(c);
        }
        reach_.assign(static_cast<std::size_t>(task_.out.height()), {task_.out.x_end, task_.out.x_begin});
        parallel_for(reach_.size(), [&](std::size_t r) {
            const int y = task_.out.y_begin + static_cast<int>(r);
            ColumnRange& reach = reach_[r];
            for (int j = std::max(task_.path.y_begin, y - task_.source.y_end + 1);
                 j < std::min(task_.path.y_end, y - task_.source.y_begin + 1); ++j) {
                const ColumnRange p = path_rows[static_cast<std::size_t>(j - task_.path.y_begin)];
                const ColumnRange s = task_.columns(y - j);
                if (p.is_empty() || s.is_empty()) continue;
                reach = {std::min(reach.begin, s.begin + p.begin), std::max(reach.end, s.end + p.end - 1)};
            }
        });
    }

    void run_block(std::size_t plane, int bx, int by, Buffers& buffers, Planes& result) const {
        const CellWindow& o = task_.out;
        const int x0 = o.x_begin + bx * x_.length, x1 = std::min(x0 + x_.length, o.x_end);
        const int y0 = o.y_begin + by * y_.length, y1 = std::min(y0 + y_.length, o.y_end);
        const bool is_positive = lay_source(plane, {x0, x1, y0, y1}, buffers.cells.get());
        std::complex<float>* spectrum = buffers.spectrum.get();
        fftwf_execute_dft_r2c(forward_, buffers.cells.get(), raw(spectrum));
        multiply(reinterpret_cast<float*>(spectrum), reinterpret_cast<const float*>(path_.get()),
                 spectrum_width_ * height_);
        fftwf_execute_dft_c2r(backward_, raw(spectrum), buffers.cells.get());
        for (int y = y0; y < y1; ++y) {
            const ColumnRange reach = reach_[static_cast<std::size_t>(y - o.y_begin)];
            const float* from = buffers.cells.get() + static_cast<std::size_t>(y - y0) * width_ - x0;
            float* to = result.planes[plane].data() +
                        static_cast<std::ptrdiff_t>(y - result.y_begin) * result.width - result.x_begin;
            for (int x = std::max(x0, reach.begin); x < std::min(x1, reach.end); ++x)
                to[x] = is_positive ? std::max(0.0F, from[x]) : from[x];
        }
    }

    /// Copies one plane of the moving object's image to `cells`, the input of the FFT. Only pixels that the
    /// blur kernel can spread into `block`, the computed part of the result, are copied, and all other cells
    /// become 0. Returns true if no copied value is negative.
    bool lay_source(std::size_t plane, const CellWindow& block, float* cells) const {
        std::fill_n(cells, width_ * height_, 0.0F);
        const CellWindow &s = task_.source, &p = task_.path;
        float least = 0;
        for (int y = std::max(s.y_begin, block.y_begin - p.y_end + 1);
             y < std::min(s.y_end, block.y_end - p.y_begin); ++y) {
            const float* from = task_.row(plane, y);
            float* to = cells + wrapped(y - block.y_begin, y_.size) * width_;
            const ColumnRange c = task_.columns(y);
            const int begin = std::max(c.begin, block.x_begin - p.x_end + 1);
            const int end = std::min(c.end, block.x_end - p.x_begin);
            if (begin >= end) continue;
            const std::size_t at = wrapped(begin - block.x_begin, x_.size);
            const std::size_t count = static_cast<std::size_t>(end - begin),
                              before = std::min(count, width_ - at);
            std::copy_n(from + begin, before, to + at);
            std::copy_n(from + begin + before, count - before, to);
            least = std::min(least, least_of(from + begin, count));
        }
        return least >= 0;
    }

    const ConvolutionTask& task_;
    AxisBlocks x_, y_;
    std::size_t width_ = 0, height_ = 0, spectrum_width_ = 0;
    fftwf_plan forward_ = nullptr, backward_ = nullptr;
    std::unique_ptr<std::complex<float>[], Free> path_;
    std::vector<ColumnRange> reach_;
    std::mutex spare_mutex_;
    std::vector<Buffers> spare_;
};

}  // namespace

int fast_fft_size(int n) {
    for (;; ++n) {
        int rest = n;
        for (const int factor : {2, 3, 5, 7})
            while (rest % factor == 0) rest /= factor;
        if (rest == 1) return n;
    }
}

void convolve_fft(const ConvolutionTask& task, Planes& result) {
    if (task.is_empty()) return;
    FftConvolution(task, best_tiling(task)).run(result);
}

double fft_cost_s(const ConvolutionTask& task) {
    return task.is_empty() ? 0 : best_tiling(task).cost_s;
}

}  // namespace postlens
