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
    const auto width = static_cast<std::size_t>(image.width);
    std::vector<double> luminance(width * static_cast<std::size_t>(image.height));
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const float* rgb = image.rgb.data() + 3 * y * width;
        for (std::size_t x = 0; x < width; ++x)
            luminance[y * width + x] = std::clamp(luminance_of(rgb + 3 * x), 0.0, 1.0);
    });
    return sum_of_rows(image.height, [&](std::size_t y) {
        const double* here = luminance.data() + y * width;
        const double* below = static_cast<int>(y) + 1 < image.height ? here + width : here;
        double sum = 0;
        for (std::size_t x = 0; x < width; ++x) {
            const double right = x + 1 < width ? here[x + 1] - here[x] : 0, down = below[x] - here[x];
            sum += right * right + down * down;
        }
        return sum;
    });
}

}  // namespace postlens
