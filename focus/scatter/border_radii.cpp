#include "focus/scatter/border_radii.h"

#include <algorithm>

#include "focus/responses/depth_levels.h"

namespace postlens {

BorderRadii::BorderRadii(const RasterWindow& source)
    : top(static_cast<std::size_t>(source.width())),
      bottom(static_cast<std::size_t>(source.width())),
      left(static_cast<std::size_t>(source.height())),
      right(static_cast<std::size_t>(source.height())) {}

void BorderRadii::note(const RasterWindow& source, const PointSample& s, int y, double radius_px) {
    const auto r = static_cast<float>(std::min(radius_px, DepthLevels::largest_radius_px));
    const int x = static_cast<int>(s.x);
    if (static_cast<float>(x) != s.x) return;
    const auto column = static_cast<std::size_t>(x - source.x_begin);
    const auto row = static_cast<std::size_t>(y - source.y_begin);
    const auto raise = [r](float& to) { to = std::max(to, r); };
    if (x == source.x_begin) raise(left[row]);
    if (x == source.x_end - 1) raise(right[row]);
    if (static_cast<float>(y) != s.y) return;
    if (y == source.y_begin) raise(top[column]);
    if (y == source.y_end - 1) raise(bottom[column]);
}

void BorderRadii::note_pixel(const RasterWindow& source, int x, int y, double radius_px) {
    const int last_y = y == source.y_end - 2 ? y + 1 : y;
    for (int v = y; v <= last_y; ++v) {
        for (const int u : {x, x + 1})
            note(source, {.x = static_cast<float>(u), .y = static_cast<float>(v)}, v, radius_px);
    }
}

}  // namespace postlens
