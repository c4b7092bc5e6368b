// Measures the errors of an image by two independent halves of its views and by check rays.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "focus/light_field/field_focus.h"
#include "planner/views/checked_pixels.h"
#include "planner/views/tile_grid.h"

namespace postlens {

/// Squared errors of a tile: sRGB values clamped to [0, 1], means over pixels and channels.
struct TileError {
    int pixels = 0;        ///< number of measured pixels
    double noise_mse = 0;  ///< noise of the mean of the halves (measured_error)
    /// Estimated squared difference between another image and the expectation of the views; may be negative.
    double other_mse = 0;
    double of_noise = 0;    ///< variance of (`noise_mse` minus the actual squared noise)
    double of_product = 0;  ///< variance of the mean product of the noise and the other image's difference
    std::vector<TileError> pieces;  ///< the parts of this tile that have independent noise
    double bias_mse = 0;            ///< error of the records, estimated by check rays; may be negative
    double bias_deviation = 0;      ///< standard error of `bias_mse`
    double highlights_mse = 0;      ///< error of the highlights, as `bias_mse`; not a part of it
    double highlights_deviation = 0;

    /// For an image that is a mean, in which the views have the weight 1 - w and the other image the weight
    /// w. Its squared error is estimated as (1 - w)^2 noise_mse + w^2 other_mse. The actual squared error is
    /// random, too. Returns the variance of the difference between the estimate and the actual squared error.
    [[nodiscard]] double estimate_variance(double w) const {
        return (1 - 2 * w) * (1 - 2 * w) * of_noise + 4 * w * w * of_product;
    }
};

struct MeasuredError {
    std::vector<TileError> tiles;  ///< one per tile of TileGrid, row by row
    /// Errors of the records in the image, measured by check rays; estimates, may be negative.
    double bias_mse = 0;
    double highlights_mse = 0;  ///< the part of `bias_mse` that is due to highlights
    double bias_variance = 0;   ///< variance of `bias_mse`
    std::uint64_t check_rays = 0;
};

/// Measures the errors of `a` and `b`. These are two images with equally many views, from independent sets of
/// lens points, and with comparisons between view samples and rays. Only pixels within `crop` are measured.
/// `checked` and `use` select the check rays. `other`: another image of the same scene, which does not depend
/// on the views; null if there is none. The result is bit-identical for any number of threads.
///
/// Noise: the mean squared difference of the halves from (a + b) / 2, as sRGB values [mccarthy1969]. It is
/// (a - b)^2 / 4 where the curve is straight, and more where it is bent or values are clamped: the noise of a
/// bright outline lies in the pixels that both halves miss.
///
/// Bias: a checked pixel has two mean residuals (ray minus record), one per half. Their noise is independent,
/// so the expectation of their product is the squared error of the records. The variance of the product is
/// taken to be at least the square of the tile's mean squared residual. Otherwise it would be too small where
/// large residuals are so rare that no pixel has two. Residuals are converted to sRGB values by the slope of
/// the sRGB curve at the image's value.
///
/// Other image: let o be the other image. The noise of `a` and `b` is independent, so the squared difference
/// between o and the expectation of the views is the expectation of (o - a)(o - b).
///
/// The variances assume that errors are normally distributed, equal within a square piece of the image
/// (piece_px), and independent between pieces.
[[nodiscard]] MeasuredError measured_error(const FieldFocus& a, const FieldFocus& b,
                                           const std::optional<Crop>& crop, const CheckedPixels& checked,
                                           CheckedPixels::Use use, const Image* other = nullptr);

/// Selects the tiles with the largest values, until the values of all other tiles add up to at most `most`.
/// `value(tile, share)` returns the contribution of a tile that is this share of the image. Only tiles with
/// positive values are selected. Returns 1 for selected tiles.
template <typename Value>
[[nodiscard]] std::vector<std::uint8_t> largest_tiles(const std::vector<TileError>& tiles,
                                                      const TileGrid& grid, double most, const Value& value) {
    const double pixels = static_cast<double>(grid.width) * grid.height;
    std::vector<std::pair<double, std::size_t>> order;
    double left = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        order.emplace_back(-value(tiles[t], grid.pixels(t) / pixels), t);
        left -= order.back().first;
    }
    std::sort(order.begin(), order.end());
    std::vector<std::uint8_t> out(tiles.size(), 0);
    for (const auto& [less, t] : order) {
        if (left <= most || less >= 0) break;
        left += less;
        out[t] = 1;
    }
    return out;
}

/// Returns an estimate of the squared noise that the highlights of each tile would have if rays showed them,
/// as many as `views` of the tile. `a` and `b`: the halves, whose highlights are spread by impulse responses.
[[nodiscard]] std::vector<double> highlights_noise(const FieldFocus& a, const FieldFocus& b,
                                                   const TileGrid& grid, const std::vector<int>& views);

/// Returns 1 for tiles in which rays should replace all view samples, because the records are in error there
/// (TileError::bias_mse). These are, first, the tiles with the largest errors, until the remaining tiles
/// contribute at most `most_mse` to the mean over the image. They are also all tiles whose error exceeds the
/// noise of their views, twice the standard error of the error, and `fine_mse`, which is good enough for any
/// tile.
[[nodiscard]] std::vector<std::uint8_t> biased_tiles(const MeasuredError& measured, const TileGrid& grid,
                                                     double most_mse, double fine_mse);

}  // namespace postlens
