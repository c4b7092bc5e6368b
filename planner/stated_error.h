// How far a picture of views and rays is from the truth: measured, not predicted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "focus/field_focus.h"

namespace postlens {

/// Which views of which pixels are compared with rays. A pixel in each block of edge x edge has some views of
/// each set, picked at random, for the statement; another one, for deciding what is traced altogether.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// Of a picture, px: small ones are checked more densely.
    CheckedPixels(int width, int height);
    [[nodiscard]] Use use(int x, int y) const;
    /// Appends which of so many views of a set, from the `first` of it on, are compared in the pixel.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;

  private:
    int edge_;
};

/// Squared errors of encoded values, clamped to [0, 1], mean of pixels and channels.
struct StatedError {
    double noise_mse = 0;  ///< of the views: half the squared difference of two independent halves, halved
    double bias_mse = 0;   ///< of what the records were sure of, by what rays of the checks found
    double low_mse = 0, high_mse = 0;  ///< 95 % interval of the picture's
    std::uint64_t check_rays = 0;
    [[nodiscard]] double mse() const { return noise_mse + bias_mse; }
    [[nodiscard]] double db() const;
    [[nodiscard]] double low_db() const;   ///< of high_mse
    [[nodiscard]] double high_db() const;  ///< of low_mse
};

/// Of the mean of two pictures whose views are independent sets, of as many views, each with its checks.
///
/// The squared difference of the halves, over four, has the mean square of the noise of their mean as its
/// expectation. Of the two mean residuals of a checked pixel, one of each set, the product has the square of
/// what both have in common: neither noise of views nor of rays adds to it. Both are taken to encoded values,
/// the residuals by the slope of the curve at the picture's value. The interval is normal in the logarithm;
/// its variance that of the halves and once more for the picture, as if a piece's pixels (piece_px) erred
/// alike and the pieces independently, and that of the products.
[[nodiscard]] StatedError stated_error(const FieldFocus& a, const FieldFocus& b,
                                       const std::optional<Crop>& crop,
                                       CheckedPixels::Use checks = CheckedPixels::Use::stating);

/// Of a tile, encoded values, means of pixels and channels.
struct TileError {
    double noise_mse = 0;
    double bias_mse = 0;        ///< by the deciding checks; may be negative
    double bias_deviation = 0;  ///< standard error of it
};
/// By tile of 64 px, row by row.
[[nodiscard]] std::vector<TileError> tile_errors(const FieldFocus& a, const FieldFocus& b);

/// Those, 1, in which what the records are sure of is off by as much as the noise: the products of the
/// deciding checks add up to more than twice their standard error, and to more than that.
[[nodiscard]] std::vector<std::uint8_t> biased_tiles(const std::vector<TileError>& tiles);

}  // namespace postlens
