#include "planner/stated_error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/sample_hash.h"
#include "pictures/crop.h"
#include "pictures/srgb.h"
#include "planner/views/tile_grid.h"

namespace postlens {
namespace {

std::uint64_t hash_of(std::uint64_t x, std::uint64_t y, std::uint64_t purpose) {
    return mix64(mix64(mix64(x) ^ y) ^ purpose);
}

/// Derivative of the sRGB transfer curve; 0 where values are clamped to [0, 1].
double slope(double linear) {
    if (!(linear >= 0) || linear >= 1) return 0;
    return linear <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(linear, 1 / 2.4 - 1);
}

double encoded(float linear) {
    return static_cast<double>(srgb_from_linear(linear));
}

/// Squared noise of the mean of the images `a` and `b` in a pixel, as a mean over channels.
double noise_at(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    double sum = 0;
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double d = encoded(a.image.rgb[c]) - encoded(b.image.rgb[c]);
        sum += d * d / 4;
    }
    return sum / 3;
}

/// Residuals of the two halves in a pixel, as encoded values per channel.
struct Residuals {
    std::array<double, 3> a{}, b{};
};
/// Product of the residuals of two independent halves: an estimate of the squared error, as a mean over
/// channels.
double product(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / 3;
}

/// Mean residuals (ray minus record) of the views' samples. They have much noise, so they are converted by
/// the slope of the sRGB curve.
Residuals view_residuals(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    Residuals out;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t k = 3 * pixel + c;
        const double s =
            slope((static_cast<double>(a.image.rgb[k]) + static_cast<double>(b.image.rgb[k])) / 2);
        out.a[c] = s * a.checks[pixel].mean(c);
        out.b[c] = s * b.checks[pixel].mean(c);
    }
    return out;
}

/// Residuals of the highlights. They have little noise and may exceed the range of the sRGB curve, so they
/// are differences on the curve.
Residuals highlight_residuals(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    Residuals out;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t k = 3 * pixel + c;
        const float value = (a.image.rgb[k] + b.image.rgb[k]) / 2;
        const auto residual = [&](const PixelCheck& check) {
            const double off = check.highlight_residual(c);
            return off == 0 ? 0 : encoded(value + static_cast<float>(off)) - encoded(value);
        };
        out.a[c] = residual(a.checks[pixel]);
        out.b[c] = residual(b.checks[pixel]);
    }
    return out;
}

struct Mean {
    double count = 0, sum = 0, squares = 0;
    void add(double value) {
        ++count;
        sum += value;
        squares += value * value;
    }
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
    /// Variance of the mean.
    [[nodiscard]] double variance() const {
        return count > 1 ? std::max(0.0, squares / count - mean() * mean()) / (count - 1) : 0;
    }
};

/// Sum over all pixels, estimated from pixels that are chosen with known probability. The variance counts
/// each value's square, not only the choice of pixels, because the values themselves have noise.
struct ChosenSum {
    double sum = 0, variance = 0;
    void add(double value, double probability) {
        sum += value / probability;
        variance += value * value / (probability * probability);
    }
};

}  // namespace

CheckedPixels::CheckedPixels(int width, int height) {
    // Products of residuals (ray minus record) have a wide distribution. With 8000 of them, their mean is
    // known well enough.
    constexpr int enough_pixels = 8000, sparse = 4, dense = 2;
    edge_ = std::int64_t{width} * height / (sparse * sparse) >= enough_pixels ? sparse : dense;
}

CheckedPixels::Place CheckedPixels::place_of(int x, int y) const {
    const auto edge = static_cast<std::uint64_t>(edge_), column = static_cast<std::uint64_t>(x),
               row = static_cast<std::uint64_t>(y), h = hash_of(column / edge, row / edge, 1);
    return {h, row % edge * edge + column % edge, h % pixels()};
}

CheckedPixels::Use CheckedPixels::use(int x, int y) const {
    const Place p = place_of(x, y);
    const std::uint64_t deciding = (p.stating + 1 + (p.hash >> 32U) % (pixels() - 1)) % pixels();
    return p.place == p.stating ? Use::stating : p.place == deciding ? Use::deciding : Use::none;
}

double CheckedPixels::aimed(int x, int y, int views) const {
    // A half of this many views or more has aimed rays in all pixels.
    constexpr int all_from_views = 128;
    const std::uint64_t chosen =
        std::clamp<std::uint64_t>(pixels() * static_cast<std::uint64_t>(views) / all_from_views, 1, pixels());
    const Place p = place_of(x, y);
    // The odd factor visits all places of a block, and no neighbours one after the other.
    constexpr std::uint64_t step = 7;
    const std::uint64_t rank = (p.place + pixels() - p.stating) * step % pixels();
    return rank < chosen ? static_cast<double>(chosen) / static_cast<double>(pixels()) : 0;
}

void CheckedPixels::views(int x, int y, int set, int first, int count,
                          std::vector<std::uint32_t>& out) const {
    if (use(x, y) == Use::none) return;
    const std::uint64_t h =
        hash_of(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                2 + static_cast<std::uint64_t>(set) + 2 * static_cast<std::uint64_t>(first));
    // Two views per half are checked in each checked pixel. Doubling the rays in a pixel divides the variance
    // of the product of two noisy means by four. Doubling the pixels would only divide it by two.
    const auto views = static_cast<std::uint64_t>(count);
    out.push_back(static_cast<std::uint32_t>(h % views));
    if (views > 1) out.push_back(static_cast<std::uint32_t>((h + 1 + (h >> 32U) % (views - 1)) % views));
}

double StatedError::db() const {
    return -10 * std::log10(std::max(mse(), 1e-12));
}
double StatedError::low_db() const {
    return -10 * std::log10(std::max(high_mse, 1e-12));
}
double StatedError::high_db() const {
    return -10 * std::log10(std::max(low_mse, 1e-12));
}

StatedError stated_error(const FieldFocus& a, const FieldFocus& b, const std::optional<Crop>& crop,
                         CheckedPixels::Use checks) {
    const int width = a.image.width, height = a.image.height, piece = piece_px(width, height);
    const CheckedPixels checked(width, height);
    Mean bias;
    ChosenSum highlights;
    double noise_sum = 0, noise_squares = 0, pixels = 0;
    StatedError out;
    for (int y0 = 0; y0 < height; y0 += piece) {
        for (int x0 = 0; x0 < width; x0 += piece) {
            double sum = 0;
            for (int y = y0; y < std::min(y0 + piece, height); ++y) {
                for (int x = x0; x < std::min(x0 + piece, width); ++x) {
                    if (crop && !crop->contains(x, y)) continue;
                    const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                   static_cast<std::size_t>(x);
                    sum += noise_at(a, b, k);
                    ++pixels;
                    if (a.checks.empty()) continue;
                    const PixelCheck &of_a = a.checks[k], &of_b = b.checks[k];
                    out.check_rays += of_a.rays + of_b.rays + of_a.aimed + of_b.aimed;
                    const bool is_stating = checked.use(x, y) == checks;
                    const auto chosen = static_cast<double>(std::min(of_a.aimed_share, of_b.aimed_share));
                    if (!is_stating && chosen == 0) continue;
                    const Residuals lights = highlight_residuals(a, b, k);
                    if (is_stating) {
                        const Residuals views = view_residuals(a, b, k);
                        bias.add(product(views.a, views.b) + product(views.a, lights.b) +
                                 product(lights.a, views.b));
                    }
                    if (chosen > 0) highlights.add(product(lights.a, lights.b), chosen);
                }
            }
            noise_sum += sum;
            noise_squares += sum * sum;
        }
    }
    pixels = std::max(pixels, 1.0);
    out.noise_mse = noise_sum / pixels;
    out.highlights_mse = std::max(0.0, highlights.sum / pixels);
    out.bias_mse = std::max(0.0, bias.mean() + highlights.sum / pixels);
    const double mse = out.mse();
    if (!(mse > 0)) return out;
    // Let the error of a square piece of the image be normally distributed and equal in all its pixels. Its
    // square s then has the variance 2 E(s)^2, and E(s^2) = 3 E(s)^2, so 2/3 s^2 estimates the variance. The
    // variance counts twice, because both the noise estimate and the noise of this particular image have it.
    const double noise_variance = 2 * 2.0 / 3 * noise_squares / (pixels * pixels),
                 deviation =
                     std::sqrt(noise_variance + bias.variance() + highlights.variance / (pixels * pixels));
    // 95 % of a normal distribution lie within 1.96 standard deviations. Here the error's logarithm is
    // normally distributed.
    const double factor = std::exp(1.96 * deviation / mse);
    out.low_mse = mse / factor;
    out.high_mse = mse * factor;
    return out;
}

std::vector<TileError> tile_errors(const FieldFocus& a, const FieldFocus& b) {
    const TileGrid grid{a.image.width, a.image.height};
    const CheckedPixels checked(grid.width, grid.height);
    std::vector<Mean> noise(grid.count()), bias(grid.count());
    for (int y = 0; y < a.image.height; ++y) {
        for (int x = 0; x < a.image.width; ++x) {
            const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(a.image.width) +
                           static_cast<std::size_t>(x);
            const std::size_t tile = grid.at(x, y);
            noise[tile].add(noise_at(a, b, k));
            if (!a.checks.empty() && checked.use(x, y) == CheckedPixels::Use::deciding) {
                const Residuals views = view_residuals(a, b, k);
                bias[tile].add(product(views.a, views.b));
            }
        }
    }
    std::vector<TileError> out;
    for (std::size_t t = 0; t < grid.count(); ++t)
        out.push_back({noise[t].mean(), bias[t].mean(), std::sqrt(bias[t].variance())});
    return out;
}

std::vector<std::uint8_t> biased_tiles(const std::vector<TileError>& tiles) {
    std::vector<std::uint8_t> out(tiles.size(), 0);
    std::transform(tiles.begin(), tiles.end(), out.begin(), [](const TileError& t) {
        return static_cast<std::uint8_t>(t.bias_mse > t.noise_mse && t.bias_mse > 2 * t.bias_deviation);
    });
    return out;
}

}  // namespace postlens
