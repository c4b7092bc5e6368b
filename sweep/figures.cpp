#include "sweep/figures.h"

#include <algorithm>
#include <cmath>

#include "compare/picture_tone.h"
#include "compare/pixel_mask.h"
#include "core/threads.h"
#include "focus/node_response.h"

namespace postlens {

FrameDepths frame_depths(FocusFrame& frame) {
    const SampleHeader& h = frame.file().header();
    FrameDepths out{
        h.width, h.height,
        std::vector<float>(static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height))};
    frame.visit_rows(0, h.height, [&](const FrameRows& rows) {
        const int begin = std::max(rows.y_begin, 0), end = std::min(rows.y_end, h.height);
        for (int y = begin; y < end; ++y) {
            const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(h.width);
            for (int x = 0; x < h.width; ++x) {
                // Records of a pixel begin with the primary node of its upper left corner.
                const std::size_t k = rows.band->pixel(x, y);
                const std::uint32_t first = rows.band->offsets[k];
                if (first == rows.band->offsets[k + 1]) continue;
                out.inverse_z[row + static_cast<std::size_t>(x)] =
                    static_cast<float>(inverse_depth_per_m(rows.band->records[first]));
            }
        }
    });
    return out;
}

double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                      double limit_px) {
    if (!geometry) return 1;
    const auto sharp = std::count_if(depths.inverse_z.begin(), depths.inverse_z.end(), [&](float inverse_z) {
        return std::abs(geometry->coc_diameter_px(static_cast<double>(inverse_z))) < limit_px;
    });
    return static_cast<double>(sharp) / static_cast<double>(depths.inverse_z.size());
}

double gradient_energy(const Image& image) {
    const auto at = [&image](int x, std::size_t y) {
        return std::clamp(luminance_of(image.pixel(x, static_cast<int>(y))), 0.0, 1.0);
    };
    return sum_of_rows(image.height, [&](std::size_t y) {
        const bool below = static_cast<int>(y) + 1 < image.height;
        double sum = 0;
        for (int x = 0; x < image.width; ++x) {
            const double here = at(x, y);
            const double right = x + 1 < image.width ? at(x + 1, y) - here : 0,
                         down = below ? at(x, y + 1) - here : 0;
            sum += right * right + down * down;
        }
        return sum;
    });
}

}  // namespace postlens
