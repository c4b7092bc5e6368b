#include "compare/metrics/ssim.h"

#include <array>
#include <cmath>
#include <limits>

#include "compare/metrics/separable.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

constexpr int window_radius = 5;
constexpr std::size_t in_width = tile_width + 2 * window_radius, in_height = tile_height + 2 * window_radius;

// Taps of the Gaussian window, with a standard deviation of 1.5 px [wang2004, sec. III-C]. They sum to 1.
std::array<float, 2 * window_radius + 1> window() {
    std::array<double, 2 * window_radius + 1> w{};
    double sum = 0;
    for (int k = -window_radius; k <= window_radius; ++k) {
        const double v = std::exp(-k * k / (2 * 1.5 * 1.5));
        w[static_cast<std::size_t>(k + window_radius)] = v;
        sum += v;
    }
    std::array<float, 2 * window_radius + 1> out{};
    std::transform(w.begin(), w.end(), out.begin(), [sum](double v) { return static_cast<float>(v / sum); });
    return out;
}

// Means and mean squares, within a window around each pixel, from which SSIM is computed for two images a and
// b. The usual formula [wang2004] needs the mean product of a and b. Here, the difference d = a - b replaces
// it, so that the result remains precise if a and b are nearly equal.
struct Moments {
    TileChannel a, d, aa, bb, dd;
    explicit Moments(std::size_t size) : a(size), d(size), aa(size), bb(size), dd(size) {}
    [[nodiscard]] std::array<TileChannel*, 5> planes() { return {&a, &d, &aa, &bb, &dd}; }
};

void load(const Image& a, const Image& b, const PixelMask& usable, int x0, int y0, Moments& to) {
    for (std::size_t y = 0; y < in_height; ++y) {
        const int py = std::clamp(y0 - window_radius + static_cast<int>(y), 0, a.height - 1);
        for (std::size_t x = 0; x < in_width; ++x) {
            const int px = std::clamp(x0 - window_radius + static_cast<int>(x), 0, a.width - 1);
            const std::size_t pixel = static_cast<std::size_t>(py) * static_cast<std::size_t>(a.width) +
                                      static_cast<std::size_t>(px);
            const bool counts = usable[pixel] != 0;
            const float va = counts ? luminance(a.pixel(px, py)) : 0.0F,
                        vb = counts ? luminance(b.pixel(px, py)) : 0.0F;
            const std::size_t i = y * in_width + x;
            to.a[i] = va;
            to.d[i] = va - vb;
            to.aa[i] = va * va;
            to.bb[i] = vb * vb;
            to.dd[i] = (va - vb) * (va - vb);
        }
    }
}

float similarity(const Moments& m, std::size_t i) {
    constexpr float c1 = 0.01F * 0.01F, c2 = 0.03F * 0.03F;
    const float mean_a = m.a[i], mean_d = m.d[i], mean_b = mean_a - mean_d;
    const float variances = m.aa[i] - mean_a * mean_a + (m.bb[i] - mean_b * mean_b);
    const float variance_d = std::max(0.0F, m.dd[i] - mean_d * mean_d);
    return (1 - mean_d * mean_d / (mean_a * mean_a + mean_b * mean_b + c1)) *
           (1 - variance_d / (std::max(0.0F, variances) + c2));
}

}  // namespace

std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded, const PixelMask& usable) {
    const int width = a_encoded.width, height = a_encoded.height;
    std::vector<float> map(usable.size(), std::numeric_limits<float>::quiet_NaN());
    const auto taps = window();
    for_each_tile(width, height, [&](int x0, int y0) {
        Moments in(in_width * in_height), rows(tile_width * in_height), out(tile_width * tile_height);
        load(a_encoded, b_encoded, usable, x0, y0, in);
        for (std::size_t p = 0; p < in.planes().size(); ++p) {
            filter_rows(*in.planes()[p], in_height, taps, *rows.planes()[p]);
            filter_columns(*rows.planes()[p], taps, *out.planes()[p]);
        }
        for (int y = std::max(y0, window_radius); y < std::min(y0 + tile_height, height - window_radius);
             ++y) {
            for (int x = std::max(x0, window_radius); x < std::min(x0 + tile_width, width - window_radius);
                 ++x) {
                map[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)] =
                    similarity(out, static_cast<std::size_t>((y - y0) * tile_width + x - x0));
            }
        }
    });
    return map;
}

}  // namespace postlens
