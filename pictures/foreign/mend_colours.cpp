#include "pictures/foreign/mend_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace postlens {
namespace {

/// Repairs the colour of a sample, `s`, that is not finite. Returns the sample with the mean colour of those
/// neighbours of the pixel (x, y) whose colours are finite, or empty if there are none. x and y are counted
/// from the first stored pixel.
std::optional<StackSample> mean_around(const ForeignPicture& p, StackSample s, int x, int y) {
    const int width = p.x_end - p.x_begin, height = p.y_end - p.y_begin;
    std::array<double, 3> sum{};
    int count = 0;
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
            const auto around = p.stack(p.x_begin + u, p.y_begin + v);
            if (around.empty() || !has_finite_colour(around[0])) continue;
            sum[0] += static_cast<double>(around[0].r);
            sum[1] += static_cast<double>(around[0].g);
            sum[2] += static_cast<double>(around[0].b);
            ++count;
        }
    }
    if (count == 0) return std::nullopt;
    s.r = static_cast<float>(sum[0] / count);
    s.g = static_cast<float>(sum[1] / count);
    s.b = static_cast<float>(sum[2] / count);
    return s;
}

}  // namespace

MendedColours mend_colours(ForeignPicture& picture) {
    MendedColours out;
    std::vector<std::pair<std::size_t, StackSample>> mended;
    const int width = picture.x_end - picture.x_begin;
    for (std::size_t i = 0; i + 1 < picture.offsets.size(); ++i) {
        for (std::uint64_t k = picture.offsets[i]; k < picture.offsets[i + 1]; ++k) {
            if (has_finite_colour(picture.samples[k])) continue;
            StackSample black = picture.samples[k];
            black.r = black.g = black.b = 0;
            std::optional<StackSample> mean;
            if (!picture.deep)
                mean = mean_around(picture, black, static_cast<int>(i) % width, static_cast<int>(i) / width);
            ++(mean ? out.by_mean : out.by_black);
            mended.emplace_back(k, mean.value_or(black));
        }
    }
    for (const auto& [k, s] : mended) picture.samples[k] = s;
    return out;
}

}  // namespace postlens
