// The error of an image made of views and rays, measured by independent halves of the views and by check
// rays.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "focus/light_field/field_focus.h"

namespace postlens {

/// Selects the samples of views that are compared with rays. In each block of 4 x 4 px (2 x 2 px in small
/// images), one random pixel is checked to state the image's error. Another random pixel is checked to decide
/// in which tiles rays replace all samples. In a checked pixel, up to two random views of each half are
/// compared.
///
/// Rays are aimed at the highlights of the pixel that states the error, and of more pixels of the block the
/// more views the image has. Errors of highlights are rare and large, and their rays cost little compared
/// with many views.
class CheckedPixels {
  public:
    enum class Use : std::uint8_t { none, deciding, stating };
    /// `width`, `height`: size of the image, px.
    CheckedPixels(int width, int height);
    [[nodiscard]] Use use(int x, int y) const;
    /// Appends the numbers of the checked views among views [first, first + count) of a set. The numbers are
    /// relative to `first`: 0 to count - 1.
    void views(int x, int y, int set, int first, int count, std::vector<std::uint32_t>& out) const;
    /// PatchViews::aimed, for a half that has `views` views.
    [[nodiscard]] double aimed(int x, int y, int views) const;

  private:
    struct Place {
        std::uint64_t hash;            ///< of the block
        std::uint64_t place, stating;  ///< of the pixel in the block, and of the pixel that states the error
    };
    [[nodiscard]] Place place_of(int x, int y) const;
    /// Number of pixels of a block.
    [[nodiscard]] std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(edge_) * static_cast<std::uint64_t>(edge_);
    }
    int edge_;
};

/// Squared errors of sRGB values clamped to [0, 1], means over pixels and channels.
struct StatedError {
    double noise_mse = 0;       ///< noise of the views: a quarter of the squared difference of two halves
    double bias_mse = 0;        ///< error of the records, measured by check rays
    double highlights_mse = 0;  ///< the part of `bias_mse` that is due to highlights
    double low_mse = 0, high_mse = 0;  ///< 95 % interval of the image's error
    std::uint64_t check_rays = 0;
    [[nodiscard]] double mse() const { return noise_mse + bias_mse; }
    [[nodiscard]] double db() const;
    [[nodiscard]] double low_db() const;   ///< PSNR of high_mse
    [[nodiscard]] double high_db() const;  ///< PSNR of low_mse
};

/// Measures the error of the mean of `a` and `b`. These are two images with equally many views, from
/// independent sets of lens points, and with comparisons between view samples and rays.
///
/// Noise: the expectation of (a - b)^2 / 4 is the mean squared noise of (a + b) / 2.
///
/// Bias: a checked pixel has two mean residuals (ray minus record), one per half. Their noise is independent,
/// so the expectation of their product is the squared error of the records. Residuals are converted to sRGB
/// values by the slope of the sRGB curve at the image's value.
///
/// The 95 % interval assumes that the error's logarithm is normally distributed. Its variance is the sum of
/// three variances: of the noise estimate, of the image's own noise, and of the products of residuals. The
/// first two are equal. They assume that the error is constant within a square piece of the image (piece_px)
/// and independent between pieces.
[[nodiscard]] StatedError stated_error(const FieldFocus& a, const FieldFocus& b,
                                       const std::optional<Crop>& crop,
                                       CheckedPixels::Use checks = CheckedPixels::Use::stating);

/// Squared errors of a tile: sRGB values, means over pixels and channels.
struct TileError {
    double noise_mse = 0;
    double bias_mse = 0;        ///< error of the records, estimated by check rays; may be negative
    double bias_deviation = 0;  ///< standard error of `bias_mse`
};
/// Errors of the tiles, one element per tile of TileGrid, row by row.
[[nodiscard]] std::vector<TileError> tile_errors(const FieldFocus& a, const FieldFocus& b);

/// Returns 1 for tiles in which samples that the records seem to determine have a significant error. An error
/// is significant if it exceeds the noise of the views and twice its own standard error.
[[nodiscard]] std::vector<std::uint8_t> biased_tiles(const std::vector<TileError>& tiles);

}  // namespace postlens
