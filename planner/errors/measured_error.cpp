#include "planner/errors/measured_error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/threads.h"
#include "pictures/crop.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

/// Returns the derivative of the sRGB transfer curve. It is 0 where values are clamped to [0, 1].
double slope(double linear) {
    if (!(linear >= 0) || linear >= 1) return 0;
    return srgb_slope(linear);
}

double encoded(float linear) {
    return static_cast<double>(srgb_from_linear(linear));
}

/// Returns the estimated squared noise of one pixel of the image, as a mean over channels of sRGB values. The
/// image is the mean of `a` and `b`, two images with independent noise. So its noise is about as large as
/// half of their difference.
double noise_at(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    double out = 0;
    for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
        const double of_a = encoded(a.image.rgb[c]), of_b = encoded(b.image.rgb[c]),
                     of_both = encoded((a.image.rgb[c] + b.image.rgb[c]) / 2);
        out += ((of_both - of_a) * (of_both - of_a) + (of_both - of_b) * (of_both - of_b)) / 6;
    }
    return out;
}

/// The measured error of one pixel, for each channel: the colour of traced rays minus the colour of the
/// image, in sRGB values. `a` and `b` are two independent measurements, so their product estimates the
/// squared error without bias.
struct Residuals {
    std::array<double, 3> a{}, b{};
};
/// Returns the product of two measurements of the same error, as a mean over channels. Their noise is
/// independent, so on average it does not contribute to the product. Therefore, the product estimates the
/// squared error without bias.
double product(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / 3;
}

/// Returns the error of a pixel's recorded colour, in sRGB values: the colour of traced rays minus the
/// recorded colour. It is measured separately in the two halves of the image's views (images from different
/// lens points), `a` and `b`.
Residuals view_residuals(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    Residuals out;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t k = 3 * pixel + c;
        // The error is converted to sRGB by the slope of the sRGB curve. Applying the nonlinear curve itself
        // to noisy colours would change their mean.
        const double s =
            slope((static_cast<double>(a.image.rgb[k]) + static_cast<double>(b.image.rgb[k])) / 2);
        out.a[c] = s * a.checks[pixel].mean(c);
        out.b[c] = s * b.checks[pixel].mean(c);
    }
    return out;
}

/// Returns the error of a pixel's highlights (bright spots that the lens blurs over many pixels), in sRGB
/// values: their light as found by rays aimed at them, minus their light in the image.
Residuals highlight_residuals(const FieldFocus& a, const FieldFocus& b, std::size_t pixel) {
    Residuals out;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t k = 3 * pixel + c;
        const float value = (a.image.rgb[k] + b.image.rgb[k]) / 2;
        const auto residual = [&](const HighlightCheck& check) {
            // The linear error `off` may be so large that the slope of the sRGB curve would convert it
            // inexactly.
            const double off = check.residual(c);
            return off == 0 ? 0 : encoded(value + static_cast<float>(off)) - encoded(value);
        };
        out.a[c] = residual(a.highlight_checks[pixel]);
        out.b[c] = residual(b.highlight_checks[pixel]);
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
    void add(const Mean& more) {
        count += more.count;
        sum += more.sum;
        squares += more.squares;
    }
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
    /// Variance of the mean.
    [[nodiscard]] double variance() const {
        return count > 1 ? std::max(0.0, squares / count - mean() * mean()) / (count - 1) : 0;
    }
};

/// Estimates a sum over all pixels from a few randomly chosen pixels, whose probabilities are known.
struct ChosenSum {
    double sum = 0, variance = 0;
    void add(double value, double probability) {
        sum += value / probability;
        variance += value * value / (probability * probability);
    }
    void add(const ChosenSum& more) {
        sum += more.sum;
        variance += more.variance;
    }
};

/// Mean squared error of the measured pixels, as the mean of products. A product is the pixel's error
/// measured in one half of the views times that measured in the other half. The halves have independent
/// noise, which adds nothing to the product on average.
struct ProductMean : Mean {
    double residuals = 0;  ///< sum of the mean squared residuals of both halves
    void add(double value, const Residuals& r) {
        Mean::add(value);
        residuals += (product(r.a, r.a) + product(r.b, r.b)) / 2;
    }
    /// Variance of the sum.
    [[nodiscard]] double sum_variance() const {
        if (!(count > 1)) return 0;
        // If large errors are rare, the measured pixels may contain none of them, so the products vary too
        // little. Therefore, the square of the mean squared error is a lower bound of their variance.
        return std::max(squares - sum * sum / count, residuals * residuals / count) * count / (count - 1);
    }
    [[nodiscard]] double variance() const { return sum_variance() / std::max(count * count, 1.0); }
};

struct TileSums {
    TileError error;
    ProductMean views;  ///< errors of the records in samples of views
    Mean bias;          ///< also combined with highlights
    ChosenSum highlights;
    std::uint64_t check_rays = 0;
};

class TileMeasurement {
  public:
    TileMeasurement(const FieldFocus& a, const FieldFocus& b, const std::optional<Crop>& crop,
                    const CheckedPixels& checked, CheckedPixels::Use use)
        : a_(a), b_(b), crop_(crop), checked_(checked), use_(use), grid_{a.image.width, a.image.height} {}

    [[nodiscard]] TileSums operator()(std::size_t tile) const {
        const int piece = piece_px(grid_.width, grid_.height),
                  left = static_cast<int>(tile) % grid_.columns() * TileGrid::edge,
                  top = static_cast<int>(tile) / grid_.columns() * TileGrid::edge,
                  right = std::min(left + TileGrid::edge, grid_.width),
                  bottom = std::min(top + TileGrid::edge, grid_.height);
        TileSums out;
        std::vector<double> noise_of_pieces;
        for (int y0 = top; y0 < bottom; y0 += piece) {
            for (int x0 = left; x0 < right; x0 += piece) {
                double& noise = noise_of_pieces.emplace_back();
                for (int y = y0; y < std::min(y0 + piece, bottom); ++y) {
                    for (int x = x0; x < std::min(x0 + piece, right); ++x) {
                        if (crop_ && !crop_->contains(x, y)) continue;
                        ++out.error.pixels;
                        noise += noise_at(a_, b_, pixel_of(x, y));
                        if (!a_.checks.empty()) add_checks(x, y, out);
                    }
                }
            }
        }
        const double pixels = std::max(out.error.pixels, 1);
        for (const double of_piece : noise_of_pieces) {
            const double noise = of_piece / pixels;
            out.error.noise_mse += noise;
            // Adds the variance of the error of `noise`. `noise` is d^2, where d is half the difference
            // between two independent images. It estimates e^2, where e is the error of their mean. d and
            // e are independent and normally distributed, with the same variance n. So e^2 - d^2 has the
            // variance 4 n^2, which is the expectation of 4/3 d^4.
            out.error.noise_variance += 4.0 / 3 * noise * noise;
        }
        out.error.bias_mse = out.views.mean();
        out.error.bias_deviation = std::sqrt(out.views.variance());
        out.error.highlights_mse = out.highlights.sum / pixels;
        out.error.highlights_deviation = std::sqrt(out.highlights.variance) / pixels;
        return out;
    }

  private:
    [[nodiscard]] std::size_t pixel_of(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width) +
               static_cast<std::size_t>(x);
    }

    void add_checks(int x, int y, TileSums& out) const {
        const std::size_t k = pixel_of(x, y);
        out.check_rays += a_.checks[k].rays + b_.checks[k].rays;
        const bool is_used = checked_.use(x, y) == use_;
        double chosen = 0;
        Residuals lights;
        if (!a_.highlight_checks.empty()) {
            const HighlightCheck &of_a = a_.highlight_checks[k], &of_b = b_.highlight_checks[k];
            out.check_rays += of_a.aimed + of_b.aimed;
            chosen = static_cast<double>(std::min(of_a.aimed_share, of_b.aimed_share));
            if (is_used || chosen > 0) lights = highlight_residuals(a_, b_, k);
        }
        if (is_used) {
            const Residuals views = view_residuals(a_, b_, k);
            const double of_views = product(views.a, views.b);
            out.views.add(of_views, views);
            out.bias.add(of_views + product(views.a, lights.b) + product(lights.a, views.b));
        }
        if (chosen > 0) out.highlights.add(product(lights.a, lights.b), chosen);
    }

    const FieldFocus &a_, &b_;
    const std::optional<Crop>& crop_;
    const CheckedPixels& checked_;
    CheckedPixels::Use use_;
    TileGrid grid_;
};

}  // namespace

MeasuredError measured_error(const FieldFocus& a, const FieldFocus& b, const std::optional<Crop>& crop,
                             const CheckedPixels& checked, CheckedPixels::Use use) {
    const TileGrid grid{a.image.width, a.image.height};
    std::vector<TileSums> sums(grid.count());
    const TileMeasurement measured(a, b, crop, checked, use);
    parallel_for(sums.size(), [&](std::size_t t) { sums[t] = measured(t); });
    MeasuredError out;
    Mean bias;
    ChosenSum highlights;
    double pixels = 0, views_variance = 0;
    for (const TileSums& tile : sums) {
        out.tiles.push_back(tile.error);
        out.check_rays += tile.check_rays;
        bias.add(tile.bias);
        views_variance += tile.views.sum_variance();
        highlights.add(tile.highlights);
        pixels += tile.error.pixels;
    }
    pixels = std::max(pixels, 1.0);
    out.highlights_mse = highlights.sum / pixels;
    out.bias_mse = bias.mean() + out.highlights_mse;
    const double of_views = views_variance / std::max(bias.count * bias.count, 1.0);
    out.bias_variance = std::max(bias.variance(), of_views) + highlights.variance / (pixels * pixels);
    return out;
}

std::vector<double> highlights_noise(const FieldFocus& a, const FieldFocus& b, const TileGrid& grid,
                                     const std::vector<int>& views) {
    std::vector<double> out(grid.count(), 0);
    if (a.light_square.empty()) return out;
    const auto variance = [](const FieldFocus& half, std::size_t k) {
        const float mean = *std::ranges::max_element(half.highlight_checks[k].light);
        return half.light_square[k] - mean * mean;
    };
    std::size_t k = 0;
    for (int y = 0; y < grid.height; ++y) {
        for (int x = 0; x < grid.width; ++x, ++k) {
            const std::size_t t = grid.at(x, y);
            const float of_ray = (variance(a, k) + variance(b, k)) / 2;
            if (!(of_ray > 0)) continue;
            // `of_ray` is the variance of a single ray. The mean of n stratified rays at an outline has the
            // variance of_ray n^(-5/4) [mitchell1996]. The image is the mean of two independent halves with n
            // = views[t] / 2 rays each, so its variance is half of that.
            const float deviation =
                std::sqrt(of_ray / 2 * std::pow(static_cast<float>(views[t]) / 2, -1.25F));
            for (std::size_t c = 3 * k; c < 3 * k + 3; ++c) {
                const float value = (a.image.rgb[c] + b.image.rgb[c]) / 2;
                for (const float off : {deviation, -deviation}) {
                    const double d = encoded(value + off) - encoded(value);
                    out[t] += d * d / (6 * grid.pixels(t));
                }
            }
        }
    }
    return out;
}

std::vector<std::uint8_t> biased_tiles(const MeasuredError& measured, const TileGrid& grid, double most_mse,
                                       double fine_mse) {
    std::vector<std::uint8_t> out =
        largest_tiles(measured.tiles, grid, most_mse,
                      [](const TileError& tile, double share) { return tile.bias_mse * share; });
    for (std::size_t i = 0; i < out.size(); ++i) {
        const TileError& tile = measured.tiles[i];
        if (tile.bias_mse > std::max(tile.noise_mse, fine_mse) && tile.bias_mse > 2 * tile.bias_deviation)
            out[i] = 1;
    }
    return out;
}

}  // namespace postlens
