#include "focus/border_depths.h"

#include <algorithm>
#include <cmath>

namespace postlens {

BorderDepths::BorderDepths(const RasterWindow& source)
    : source_(source),
      top_(static_cast<std::size_t>(source.width())),
      bottom_(top_.size()),
      left_(static_cast<std::size_t>(source.height())),
      right_(left_.size()) {}

void BorderDepths::add(const RecordBand& band, int y_begin, int y_end) {
    for (int y = y_begin; y < y_end; ++y) {
        const bool is_outermost = y == source_.y_begin || y == source_.y_end - 1;
        const int step = is_outermost ? 1 : source_.width() - 1;
        for (int x = source_.x_begin; x < source_.x_end; x += step) add_corner(band, x, y);
    }
}

void BorderDepths::add_corner(const RecordBand& band, int x, int y) {
    const std::size_t pixel = band.pixel(x, y), column = static_cast<std::size_t>(x - source_.x_begin),
                      row = static_cast<std::size_t>(y - source_.y_begin);
    for (std::uint32_t i = band.offsets[pixel]; i < band.offsets[pixel + 1]; ++i) {
        const Record& r = band.records[i];
        if (r.layer != 0 || r.path.bits() != 0 || r.x != static_cast<float>(x) ||
            r.y != static_cast<float>(y))
            continue;
        const float inverse = 1 / r.z;  // 0 if infinitely far
        const auto include = [inverse](Range& range) {
            range = {std::max(range.nearest, inverse), std::min(range.farthest, inverse)};
        };
        if (x == source_.x_begin) include(left_[row]);
        if (x == source_.x_end - 1) include(right_[row]);
        if (y == source_.y_begin) include(top_[column]);
        if (y == source_.y_end - 1) include(bottom_[column]);
    }
}

BorderRadii BorderDepths::radii(const FocusGeometry& geometry, const ResponseModel& response) const {
    BorderRadii out(source_);
    const auto fill = [&](const std::vector<Range>& from, std::vector<float>& to) {
        std::transform(from.begin(), from.end(), to.begin(), [&](const Range& range) {
            if (range.farthest > range.nearest) return 0.0F;
            // `range` has the inverse depths of the nearest and the farthest surface at a pixel corner. The
            // signed CoC is a linear function of the inverse depth, so the largest blur of all surfaces
            // between them occurs at one of these two.
            const auto radius_px = [&](float inverse) {
                return response.farthest_light_px(geometry.coc_diameter_px(static_cast<double>(inverse)) / 2);
            };
            return static_cast<float>(std::max(radius_px(range.nearest), radius_px(range.farthest)));
        });
    };
    fill(top_, out.top);
    fill(bottom_, out.bottom);
    fill(left_, out.left);
    fill(right_, out.right);
    return out;
}

}  // namespace postlens
