#include "focus/scatter/point_scatter.h"

#include <algorithm>
#include <iterator>

#include "core/multiversion.h"

namespace postlens {
namespace {

// An alias declaration would lose the attributes.
// NOLINTNEXTLINE(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));

struct PointPass {
    const Splat* splats = nullptr;
    std::size_t count = 0;
    int y = 0;  ///< raster row of the splats
    const KernelTable* kernels = nullptr;
    std::size_t channel = 0;
    RasterWindow rows;
    std::size_t stride = 0;
    double* sum = nullptr;
    double* change = nullptr;
};

POSTLENS_MULTIVERSION
void add_points(const PointPass& pass) {
    const int width = pass.rows.x_end - pass.rows.x_begin;
    for (std::size_t i = 0; i < pass.count; ++i) {
        const Splat& s = pass.splats[i];
        const Kernel& kernel = pass.kernels->kernel(s.kernel, pass.channel);
        // Column of the kernel's centre, relative to the block of pixels.
        const int x = s.x - pass.rows.x_begin;
        if (x + kernel.x_end <= 0 || x + kernel.x_begin >= width) continue;
        const FourDoubles value = {static_cast<double>(s.r), static_cast<double>(s.g),
                                   static_cast<double>(s.b), static_cast<double>(s.weight)};
        const FourDoubles inner = value * static_cast<double>(kernel.inner);
        const int first = std::max(pass.rows.y_begin, pass.y + kernel.y_begin);
        const int last = std::min(pass.rows.y_end, pass.y + kernel.y_end());
        for (int y = first; y < last; ++y) {
            const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - pass.y - kernel.y_begin)];
            const std::size_t offset = static_cast<std::size_t>(y - pass.rows.y_begin) * pass.stride * 4;
            double* sum = pass.sum + offset;
            const float* taps = kernel.taps.data() + row.tap;
            const int left_begin = x + row.x_begin, left_end = x + row.inner_begin;
            for (int at = std::max(left_begin, 0); at < std::min(left_end, width); ++at) {
                *reinterpret_cast<FourDoubles*>(sum + 4 * at) +=
                    value * static_cast<double>(taps[at - left_begin]);
            }
            const int right_begin = x + row.inner_end, right_end = x + row.x_end;
            if (right_begin == left_end) continue;
            taps += row.inner_begin - row.x_begin;
            for (int at = std::max(right_begin, 0); at < std::min(right_end, width); ++at) {
                *reinterpret_cast<FourDoubles*>(sum + 4 * at) +=
                    value * static_cast<double>(taps[at - right_begin]);
            }
            double* change = pass.change + offset;
            if (left_end < width && right_begin > 0) {
                *reinterpret_cast<FourDoubles*>(change + 4 * std::max(left_end, 0)) += inner;
                *reinterpret_cast<FourDoubles*>(change + 4 * std::min(right_begin, width)) -= inner;
            }
        }
    }
}

}  // namespace

void PointScatter::find_passes(std::size_t reach_class) {
    const RasterWindow& source = tables_.source();
    const Reach& farthest = tables_.class_reach(reach_class);
    const int last_row = std::min(source.y_end, rows_.y_end - farthest.dy_begin);
    for (int y = std::max(source.y_begin, rows_.y_begin - farthest.dy_end); y < last_row; ++y) {
        const SplatRow& row = tables_.row(y);
        const std::span<const Splat> splats = row.splats_of(reach_class);
        const Reach& reach = row.class_reach[reach_class];
        if (splats.empty() || y + reach.dy_end <= rows_.y_begin || y + reach.dy_begin >= rows_.y_end)
            continue;
        const auto first = std::lower_bound(splats.begin(), splats.end(), rows_.x_begin - reach.dx_end,
                                            [](const Splat& s, int x) { return s.x < x; });
        const auto last = std::lower_bound(first, splats.end(), rows_.x_end - reach.dx_begin,
                                           [](const Splat& s, int x) { return s.x < x; });
        if (first == last) continue;
        passes_.push_back({{first, last}, y});
        const RasterWindow theirs{first->x + reach.dx_begin, std::prev(last)->x + reach.dx_end,
                                  y + reach.dy_begin, y + reach.dy_end};
        reached_ = passes_.size() == 1 ? theirs : around(reached_, theirs);
    }
}

void PointScatter::run(const RasterWindow& rows) {
    rows_ = rows;
    reached_ = {};
    passes_.clear();
    for (std::size_t c = 0; c < reach_classes; ++c) find_passes(c);
    if (passes_.empty()) return;
    reached_ = common(reached_, rows_);
    stride_ = static_cast<std::size_t>(rows.width()) + 1;
    sum_.resize(std::max(sum_.size(), 4 * stride_ * static_cast<std::size_t>(rows.height())));
    change_.resize(sum_.size());
    // Clears the sums of all pixels. Each pixel has four values: red, green, blue and weight. `change_`
    // stores the differences of these values between neighbouring pixels of a row. Therefore, each row has
    // one extra pixel, which holds the difference after the last pixel.
    const std::size_t values = 4 * (static_cast<std::size_t>(reached_.width()) + 1);
    for (int y = reached_.y_begin; y < reached_.y_end; ++y) {
        for (auto* buffer : {&sum_, &change_})
            std::fill_n(buffer->data() + index(reached_.x_begin, y), values, 0.0);
    }
    for (const Pass& pass : passes_) {
        add_points({.splats = pass.splats.data(),
                    .count = pass.splats.size(),
                    .y = pass.y,
                    .kernels = &tables_.kernels(),
                    .channel = channel_,
                    .rows = rows_,
                    .stride = stride_,
                    .sum = sum_.data(),
                    .change = change_.data()});
    }
    for (int y = reached_.y_begin; y < reached_.y_end; ++y) {
        double* sum = sum_.data() + index(reached_.x_begin, y);
        const double* change = change_.data() + index(reached_.x_begin, y);
        double inside[4] = {};
        for (std::size_t x = 0; x < static_cast<std::size_t>(reached_.width()); ++x) {
            for (std::size_t c = 0; c < 4; ++c) {
                inside[c] += change[4 * x + c];
                sum[4 * x + c] += inside[c];
            }
        }
    }
}

}  // namespace postlens
