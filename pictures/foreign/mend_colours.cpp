#include "pictures/foreign/mend_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace postlens {
namespace {

bool finite(const StackSample& s) {
    return std::isfinite(s.r) && std::isfinite(s.g) && std::isfinite(s.b);
}

StackSample mean_around(const ForeignPicture& p, StackSample s, int x, int y) {
    const int width = p.x_end - p.x_begin, height = p.y_end - p.y_begin;
    std::array<double, 3> sum{};
    int count = 0;
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
            const auto around = p.stack(p.x_begin + u, p.y_begin + v);
            if (around.empty() || !finite(around[0])) continue;
            sum[0] += static_cast<double>(around[0].r);
            sum[1] += static_cast<double>(around[0].g);
            sum[2] += static_cast<double>(around[0].b);
            ++count;
        }
    }
    if (count == 0) return s;
    s.r = static_cast<float>(sum[0] / count);
    s.g = static_cast<float>(sum[1] / count);
    s.b = static_cast<float>(sum[2] / count);
    return s;
}

}  // namespace

std::size_t mend_colours(ForeignPicture& picture) {
    std::vector<std::pair<std::size_t, StackSample>> mended;
    const int width = picture.x_end - picture.x_begin;
    for (std::size_t i = 0; i + 1 < picture.offsets.size(); ++i) {
        for (std::uint64_t k = picture.offsets[i]; k < picture.offsets[i + 1]; ++k) {
            if (finite(picture.samples[k])) continue;
            StackSample s = picture.samples[k];
            s.r = s.g = s.b = 0;
            if (!picture.deep)
                s = mean_around(picture, s, static_cast<int>(i) % width, static_cast<int>(i) / width);
            mended.emplace_back(k, s);
        }
    }
    for (const auto& [k, s] : mended) picture.samples[k] = s;
    return mended.size();
}

}  // namespace postlens
