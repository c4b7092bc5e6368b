#include "sweep/figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/multiversion.h"
#include "core/threads.h"
#include "focus/responses/node_response.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

POSTLENS_MULTIVERSION
std::size_t sharper_than(const FocusGeometry& geometry, double limit_px, const float* inverse_z,
                         std::size_t count) {
    const FocusGeometry g = geometry;
    std::size_t out = 0;
    for (std::size_t i = 0; i < count; ++i)
        out += std::abs(g.coc_diameter_px(static_cast<double>(inverse_z[i]))) < limit_px ? 1 : 0;
    return out;
}

/// Computes the luminances of a row of pixels, clamped to 0..1.
POSTLENS_MULTIVERSION
void luminances(const float* __restrict rgb, std::size_t width, double* __restrict luminance) {
    for (std::size_t x = 0; x < width; ++x) {
        const double y = exact_luminance(rgb + 3 * x);
        luminance[x] = y > 0 ? (y < 1 ? y : 1) : 0;
    }
}

/// Sums the squared differences of a row's pixels from their neighbours to the right and below.
POSTLENS_MULTIVERSION
double squared_steps(const double* here, const double* below, std::size_t width) {
    // A fixed number of partial sums gives bit-identical results on every instruction set.
    constexpr std::size_t lanes = 8;
    double sums[lanes] = {};
    const auto step = [&](std::size_t x) {
        const double right = here[x + 1] - here[x], down = below[x] - here[x];
        return right * right + down * down;
    };
    std::size_t x = 0;
    for (; x + lanes < width; x += lanes) {
        for (std::size_t i = 0; i < lanes; ++i) sums[i] += step(x + i);
    }
    double sum = 0;
    for (; x + 1 < width; ++x) sum += step(x);
    const double down = below[x] - here[x];
    sum += down * down;
    for (const double s : sums) sum += s;
    return sum;
}

}  // namespace

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
                // A pixel's first record is the directly visible surface at its upper left corner.
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
    const std::size_t sharp =
        sharper_than(*geometry, limit_px, depths.inverse_z.data(), depths.inverse_z.size());
    return static_cast<double>(sharp) / static_cast<double>(depths.inverse_z.size());
}

double gradient_energy(const Image& image) {
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    // Number of image rows per task of parallel_for. Each row is compared with the row below it. So the first
    // row of a task is converted to luminance twice, once by the task above.
    constexpr std::size_t together = 16;
    std::vector<double> sums(height);
    parallel_for((height + together - 1) / together, [&](std::size_t block) {
        std::vector<double> here(width), below(width);
        const std::size_t first = block * together, last = std::min(first + together, height);
        const float* rgb = image.rgb.data() + 3 * first * width;
        luminances(rgb, width, here.data());
        for (std::size_t y = first; y < last; ++y) {
            rgb += 3 * width;
            const bool any_below = y + 1 < height;
            if (any_below) luminances(rgb, width, below.data());
            sums[y] = squared_steps(here.data(), any_below ? below.data() : here.data(), width);
            here.swap(below);
        }
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace postlens
