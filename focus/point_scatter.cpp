#include "focus/point_scatter.h"

#include <algorithm>

#include "core/multiversion.h"

namespace postlens {
namespace {

// An alias declaration would lose the attributes.
// NOLINTNEXTLINE(modernize-use-using): see above
typedef double FourDoubles __attribute__((vector_size(32), aligned(8), may_alias));

/// One source row's splats against the rows of a block.
struct PointPass {
    const Splat* splats = nullptr;
    std::size_t count = 0;
    int y = 0;  ///< of the source row
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
        // Columns from the block's first.
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

// Adds the splats of one reach class; `begun`: the sums have been set up. True where any splat may reach the
// rows.
bool PointScatter::add_class(std::size_t reach_class, bool begun) {
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
        if (!begun) {
            begun = true;
            sum_.assign(4 * stride_ * static_cast<std::size_t>(rows_.height()), 0.0);
            change_.assign(sum_.size(), 0.0);
        }
        add_points({.splats = &*first,
                    .count = static_cast<std::size_t>(last - first),
                    .y = y,
                    .kernels = &tables_.kernels(),
                    .channel = channel_,
                    .rows = rows_,
                    .stride = stride_,
                    .sum = sum_.data(),
                    .change = change_.data()});
    }
    return begun;
}

bool PointScatter::run(const RasterWindow& rows) {
    rows_ = rows;
    stride_ = static_cast<std::size_t>(rows.width()) + 1;
    bool any = false;
    for (std::size_t c = 0; c < reach_classes; ++c) any = add_class(c, any) || any;
    if (!any) return false;
    for (int y = 0; y < rows_.height(); ++y) {
        double* sum = sum_.data() + static_cast<std::size_t>(y) * stride_ * 4;
        const double* change = change_.data() + static_cast<std::size_t>(y) * stride_ * 4;
        double inside[4] = {};
        for (std::size_t x = 0; x < static_cast<std::size_t>(rows_.width()); ++x) {
            for (std::size_t c = 0; c < 4; ++c) {
                inside[c] += change[4 * x + c];
                sum[4 * x + c] += inside[c];
            }
        }
    }
    return true;
}

}  // namespace postlens
