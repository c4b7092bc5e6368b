#include "focus/overscan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "core/text.h"

namespace postlens {
namespace {

/// The sample file lacks surfaces outside the traced area. If their blur would reach into the image, light is
/// missing there. A warning appears only if the blur reaches farther into the image than this, in px.
constexpr double smallest_reach_px = 0.5;

/// Light from outside the traced area is not recorded. Returns for each pixel [begin, end) along one border
/// of the image how far this light would be blurred into the image, in px. This is estimated from the blur at
/// the border of the traced area.
/// - `radii`: blur radii, in px, at the pixel corners along this border, from the corner `first` on
/// - `margin_px`: distance between the two borders
std::vector<int> reach_into_picture(const std::vector<float>& radii, int first, int begin, int end,
                                    int margin_px) {
    std::vector<int> out(static_cast<std::size_t>(end - begin));
    for (int i = begin; i < end; ++i) {
        const auto at = static_cast<std::size_t>(i - first);
        const double reach = static_cast<double>(std::max(radii[at], radii[at + 1])) - margin_px;
        // Limits the blur to 1e6 px, which exceeds the size of any image.
        if (reach > smallest_reach_px)
            out[static_cast<std::size_t>(i - begin)] = static_cast<int>(std::ceil(std::min(reach, 1e6)));
    }
    return out;
}

}  // namespace

std::optional<FocusWarning> overscan_warning(const BorderRadii& border, const RasterWindow& source,
                                             const RasterWindow& picture, const std::optional<Crop>& crop) {
    const std::array<int, 4> margin{picture.x_begin - source.x_begin, source.x_end - 1 - picture.x_end,
                                    picture.y_begin - source.y_begin, source.y_end - 1 - picture.y_end};
    const auto left =
        reach_into_picture(border.left, source.y_begin, picture.y_begin, picture.y_end, margin[0]);
    const auto right =
        reach_into_picture(border.right, source.y_begin, picture.y_begin, picture.y_end, margin[1]);
    const auto top =
        reach_into_picture(border.top, source.x_begin, picture.x_begin, picture.x_end, margin[2]);
    const auto bottom =
        reach_into_picture(border.bottom, source.x_begin, picture.x_begin, picture.x_end, margin[3]);

    const auto largest = [](const std::vector<int>& reach) {
        return *std::max_element(reach.begin(), reach.end());
    };
    const std::array<int, 4> most{largest(left), largest(right), largest(top), largest(bottom)};
    if (*std::max_element(most.begin(), most.end()) == 0) return std::nullopt;
    // Computes the overscan that would avoid the missing light. It is equal on all sides of the image, so it
    // must be large enough for the side with the widest blur.
    int needed_px = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        if (most[i] > 0) needed_px = std::max(needed_px, margin[i] + most[i]);
    }

    std::int64_t concerned = 0;
    const Crop looked_at = crop.value_or(Crop{0, 0, picture.width(), picture.height()});
    for (int y = looked_at.y; y < looked_at.y + looked_at.height; ++y) {
        const auto row = static_cast<std::size_t>(y);
        for (int x = looked_at.x; x < looked_at.x + looked_at.width; ++x) {
            const auto column = static_cast<std::size_t>(x);
            if (x < left[row] || picture.width() - x <= right[row] || y < top[column] ||
                picture.height() - y <= bottom[column]) {
                ++concerned;
            }
        }
    }
    if (concerned == 0) return std::nullopt;
    const double share = static_cast<double>(concerned) / looked_at.width / looked_at.height;
    return FocusWarning{
        .code = "overscan",
        .share = share,
        .text = fmt::format(
            "{} % of the pixels lie within a circle of confusion of where the records end (got {} "
            "px of overscan; expected {} px, as the circles at the border have that radius)",
            rough(100 * share), *std::min_element(margin.begin(), margin.end()), needed_px)};
}

}  // namespace postlens
