// Measures the error of an image that is the mean of many views (images from different lens points). The
// noise is measured by the difference between two halves of the views. The error of the recorded colours is
// measured by rays in some of the pixels.
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

/// Measured errors of an image tile, by cause. All are squared errors of sRGB values clamped to [0, 1], as
/// means over pixels and channels.
struct TileError {
    int pixels = 0;        ///< number of measured pixels
    double noise_mse = 0;  ///< noise of the mean of the halves (measured_error)
    /// Variance of the difference between `noise_mse` and the actual squared noise.
    double noise_variance = 0;
    double bias_mse = 0;        ///< error of the records, estimated by check rays; may be negative
    double bias_deviation = 0;  ///< standard error of `bias_mse`
    double highlights_mse = 0;  ///< error of the highlights, not a part of `bias_mse`; may be negative
    double highlights_deviation = 0;
};

struct MeasuredError {
    std::vector<TileError> tiles;  ///< one per tile of TileGrid, row by row
    /// Squared error of the image that is due to inaccurate or missing colours in the sample file. In
    /// randomly chosen pixels, the recorded colours are compared with the colours of traced rays. Because
    /// these colours are noisy, the estimate of the squared error may be negative.
    double bias_mse = 0;
    double highlights_mse = 0;  ///< the part of `bias_mse` that highlights cause
    double bias_variance = 0;   ///< variance of `bias_mse`
    std::uint64_t check_rays = 0;
};

/// Measures the errors of an image whose views are divided into two halves, `a` and `b`. They must have equal
/// numbers of views and independent lens points. The result is bit-identical for any number of threads.
/// - `crop`: only pixels within it are measured
/// - `checked`, `use`: select the rays with which recorded colours are compared
///
/// The noise is the mean squared difference between the halves and their mean [mccarthy1969]. The bias is the
/// mean product of the residuals (ray minus recorded colour) of both halves, because their noise is
/// independent.
[[nodiscard]] MeasuredError measured_error(const FieldFocus& a, const FieldFocus& b,
                                           const std::optional<Crop>& crop, const CheckedPixels& checked,
                                           CheckedPixels::Use use);

/// Selects the worst tiles, as few as possible, so that the values of all other tiles add up to at most
/// `most`. Returns 1 for each selected tile, and 0 for the others.
/// - `value(tile, share)`: for example the tile's part of the image's squared error; `share` is the fraction
///   of the image's area that the tile covers
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

/// Predicts the noise of each tile if rays replaced the blurred light of its highlights. Returns the squared
/// noise of sRGB values for `views[tile]` rays per pixel.
/// - `a`, `b`: the images of the two halves of the views, which contain the mean and the mean square of the
///   highlights' light in each pixel
[[nodiscard]] std::vector<double> highlights_noise(const FieldFocus& a, const FieldFocus& b,
                                                   const TileGrid& grid, const std::vector<int>& views);

/// Chooses the tiles whose recorded colours are so inaccurate that rays should replace them. Returns 1 for a
/// chosen tile, and otherwise 0. The error of a tile is `bias_mse`, the squared error of its recorded
/// colours.
/// - `most_mse`: limit for the tiles that are not chosen. The worst tiles are chosen until the errors of all
///   others add up to at most this squared error of the image.
/// - `fine_mse`: a tile is also chosen if its error exceeds `fine_mse`, the tile's noise (`noise_mse`), and
///   twice the standard error of its measurement (`bias_deviation`)
[[nodiscard]] std::vector<std::uint8_t> biased_tiles(const MeasuredError& measured, const TileGrid& grid,
                                                     double most_mse, double fine_mse);

}  // namespace postlens
