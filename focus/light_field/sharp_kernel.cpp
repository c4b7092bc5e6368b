#include "focus/light_field/sharp_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "focus/responses/depth_levels.h"
#include "lens/ellipse_coverage.h"
#include "lens/response_grid.h"

namespace postlens {
namespace {

/// A rectangle is represented by points. Their distance is at most the smaller blur radius divided by this
/// number. With 4, a straight edge sends light across a nearby border of pixels with an error below 1 %.
constexpr double points_per_radius = 4;
/// Largest number of these points per blur radius in the direction in which the blur is wider. A narrow,
/// oblique blur would need more.
constexpr double most_per_radius = 32;

/// The extent of a blur along one axis, and the largest distance of points, in px.
struct Extent {
    double half_px, step_px;
};

/// Appends the points that represent the interval [begin, end], which lies within one pixel, along one axis.
/// Points are needed only near the pixel's borders, where the blur may cross them. All light farther from
/// them than the blur extends stays in the pixel, so that one point represents it.
void add_points(double begin, double end, const Extent& blur, std::vector<Span>& out) {
    const double pixel = std::floor((begin + end) / 2), length = end - begin;
    out.clear();
    if (!(length > 0)) {
        out.push_back({(begin + end) / 2, 1});
        return;
    }
    const double inner_begin = std::clamp(pixel + blur.half_px, begin, end),
                 inner_end = std::clamp(pixel + 1 - blur.half_px, inner_begin, end);
    const auto add = [&](double from, double to, double step_px) {
        if (!(to > from)) return;
        const auto count = static_cast<int>(std::ceil(std::max(1.0, (to - from) / step_px - 1e-9)));
        for (int i = 0; i < count; ++i)
            out.push_back({from + (to - from) * (i + 0.5) / count, (to - from) / count / length});
    };
    add(begin, inner_begin, blur.step_px);
    add(inner_begin, inner_end, HUGE_VAL);
    add(inner_end, end, blur.step_px);
}

/// Returns whether the blur of a point at `at` px lies within the pixel that contains the point.
bool stays_in_pixel(double at, const Extent& blur) {
    const double in_pixel = at - std::floor(at);
    return in_pixel >= blur.half_px && in_pixel + blur.half_px <= 1;
}

/// Adds `kernel`, multiplied by `weight`, to `sum`. Pixels outside `sum` are left out.
void add(const Kernel& kernel, double weight, ResponseGrid& sum) {
    for (std::size_t i = 0; i < kernel.rows.size(); ++i) {
        const KernelRow& row = kernel.rows[i];
        const int y = kernel.y_begin + static_cast<int>(i) - sum.y_begin;
        if (y < 0 || y >= sum.height) continue;
        for (int x = std::max(row.x_begin, sum.x_begin); x < std::min(row.x_end, sum.x_begin + sum.width);
             ++x)
            sum.at(x - sum.x_begin, y) += weight * kernel.at(row, x);
    }
}

}  // namespace

Kernel sharp_kernel(std::span<const SourcePart> parts, const glm::dvec2& centre_px, const glm::dmat2& map_px,
                    const ResponseModel& model, KernelReach reach) {
    const Ellipse ellipse = Ellipse::from_map(map_px, DepthLevels::smallest_radius_px);
    const double widest = std::max(ellipse.half_width(), ellipse.half_height),
                 narrowest = ellipse.half_height * ellipse.half_chord / widest,
                 step_px = std::max(narrowest / points_per_radius, widest / most_per_radius);
    Extent across{ellipse.half_width(), step_px}, down{ellipse.half_height, step_px};
    if (!model.is_round()) across.half_px = down.half_px = std::max(widest, model.reach_px(map_px));
    glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    double light = 0;
    for (const SourcePart& part : parts) {
        const glm::dvec2 middle = centre_px + glm::dvec2(part.at), half = glm::dvec2(part.size) / 2.0,
                         extent(across.half_px, down.half_px);
        low = glm::min(low, middle - half - extent);
        high = glm::max(high, middle + half + extent);
        light += static_cast<double>(part.light);
    }
    const glm::dvec2 limit(reach.x, reach.y);
    const glm::ivec2 begin(glm::floor(glm::clamp(low, -limit, limit))),
        end(glm::ceil(glm::clamp(high, -limit, limit)));
    ResponseGrid sum(begin.x, begin.y, std::max(end.x - begin.x, 0), std::max(end.y - begin.y, 0));
    std::vector<Span> columns, rows;
    for (const SourcePart& part : parts) {
        const glm::dvec2 middle = centre_px + glm::dvec2(part.at), half = glm::dvec2(part.size) / 2.0;
        add_points(middle.x - half.x, middle.x + half.x, across, columns);
        add_points(middle.y - half.y, middle.y + half.y, down, rows);
        for (const Span& y : rows) {
            for (const Span& x : columns) {
                const double weight = static_cast<double>(part.light) / light * x.share * y.share;
                if (stays_in_pixel(x.middle, across) && stays_in_pixel(y.middle, down)) {
                    const int column = static_cast<int>(std::floor(x.middle)) - sum.x_begin,
                              row = static_cast<int>(std::floor(y.middle)) - sum.y_begin;
                    if (column >= 0 && column < sum.width && row >= 0 && row < sum.height)
                        sum.at(column, row) += weight;
                    continue;
                }
                const Kernel point = model.is_round()
                                         ? make_kernel(ellipse, x.middle, y.middle, reach)
                                         : model.kernel({map_px, glm::dvec2(0), {x.middle, y.middle}, reach});
                add(point, weight, sum);
            }
        }
    }
    return make_kernel(sum, reach);
}

}  // namespace postlens
