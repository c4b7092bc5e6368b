#include "reproject/fill_gaps.h"

#include <algorithm>

namespace postlens {
namespace {

struct Level {
    int width = 0, height = 0;
    std::vector<float> rgb, weight;  // rgb is already the weighted mean
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

Level coarser(const Level& fine) {
    Level out{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
    const std::size_t n = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
    out.rgb.assign(3 * n, 0);
    out.weight.assign(n, 0);
    for (int y = 0; y < fine.height; ++y) {
        for (int x = 0; x < fine.width; ++x) {
            const std::size_t from = fine.at(x, y), to = out.at(x / 2, y / 2);
            const float w = std::min(fine.weight[from], 1.0F);
            out.weight[to] += w;
            for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * to + c] += w * fine.rgb[3 * from + c];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (out.weight[i] > 0) {
            for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * i + c] /= out.weight[i];
        }
    }
    return out;
}

/// Interpolates a colour for pixel (x, y) bilinearly from `coarse`, a level of an image pyramid whose pixels
/// are twice as wide.
void sample(const Level& coarse, int x, int y, float* rgb) {
    const int x0 = (x & 1) != 0 ? x / 2 : x / 2 - 1, y0 = (y & 1) != 0 ? y / 2 : y / 2 - 1;
    // The centre of the pixel lies a quarter of a coarse pixel beside the nearest centre of a coarse pixel:
    // to the right of it if x is odd, and to the left if x is even.
    const float fx = (x & 1) != 0 ? 0.25F : 0.75F, fy = (y & 1) != 0 ? 0.25F : 0.75F;
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = 0;
    for (int k = 0; k < 4; ++k) {
        const int cx = std::clamp(x0 + (k & 1), 0, coarse.width - 1),
                  cy = std::clamp(y0 + (k >> 1), 0, coarse.height - 1);
        const float w = ((k & 1) != 0 ? fx : 1 - fx) * ((k >> 1) != 0 ? fy : 1 - fy);
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += w * coarse.rgb[3 * coarse.at(cx, cy) + c];
    }
}

void push(const Level& coarse, Level& fine) {
    for (int y = 0; y < fine.height; ++y) {
        for (int x = 0; x < fine.width; ++x) {
            const std::size_t i = fine.at(x, y);
            const float known = std::min(fine.weight[i], 1.0F);
            if (known >= 1) continue;
            float rgb[3];
            sample(coarse, x, y, rgb);
            for (std::size_t c = 0; c < 3; ++c)
                fine.rgb[3 * i + c] = known * fine.rgb[3 * i + c] + (1 - known) * rgb[c];
        }
    }
}

}  // namespace

void fill_gaps(Image& image, const std::vector<float>& weight) {
    std::vector<Level> levels(1);
    levels[0] = {image.width, image.height, image.rgb, weight};
    // Gives known pixels the weight 1, so that filling the gaps keeps their colours, and unknown pixels the
    // weight 0. Unknown pixels are also set to black, because their colour may be infinite or NaN. Such a
    // colour would spread to the neighbouring pixels, even with the weight 0.
    for (std::size_t i = 0; i < weight.size(); ++i) {
        const bool known = weight[i] > 0;
        levels[0].weight[i] = known ? 1.0F : 0.0F;
        if (!known) std::fill_n(levels[0].rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0.0F);
    }
    while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(coarser(levels.back()));
    for (std::size_t i = levels.size() - 1; i > 0; --i) push(levels[i], levels[i - 1]);
    image.rgb = std::move(levels[0].rgb);
}

}  // namespace postlens
