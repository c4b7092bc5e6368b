// Sums the splats (impulse responses) of one LayerPart, for example a surface, over a block of pixels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// Sums of colour, weight and depth, each multiplied by the kernel, for each pixel of a block.
///
/// The uniform interior of a kernel row is stored as differences between neighbouring pixels. The cost of a
/// splat is thus proportional to the length of its kernel's outline.
class LayerSums {
  public:
    /// Values per pixel without and with lens moments. Vectors of eight values fit into one register of
    /// AVX-512.
    static constexpr std::size_t plain_values = 8, lens_values = 12;

    /// Sets the sums of the pixels of `rows` to 0. If `with_lens` is set, lens moments are summed as well.
    /// Samples lie `from_anchor_px` to the right of and below their anchors (integer raster positions).
    void begin(const RasterWindow& rows, bool with_lens, double from_anchor_px = 0);
    /// Adds splats of one row of samples, with the kernels of one channel.
    void add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel);
    /// Completes the sums. Call it after the last splat and before reading the sums.
    void finish();

    [[nodiscard]] const RasterWindow& rows() const { return rows_; }
    /// Returns the sums of red, green, blue and weight at a pixel.
    [[nodiscard]] const double* at(int x, int y) const { return sums_.data() + index(x, y) * stride_; }
    [[nodiscard]] double depth_at(int x, int y) const { return at(x, y)[4]; }
    [[nodiscard]] double covered_at(int x, int y) const { return at(x, y)[5]; }
    /// Returns the lens moments of the colours and weights that `at` returns. In a lens moment, each term of
    /// the sum is multiplied by the lens point through which its light passed, in lens radii.
    [[nodiscard]] LensMoments lens_at(int x, int y) const;

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rows_.y_begin) * width_ +
               static_cast<std::size_t>(x - rows_.x_begin);
    }

    RasterWindow rows_;
    bool with_lens_ = false;
    double from_anchor_px_ = 0;
    std::size_t width_ = 0;  ///< pixels per row of the buffers, one more than in rows_
    std::size_t stride_ = plain_values;
    /// Values of each pixel: red, green, blue, weight, depth, covered weight, sum of colours C and weight W
    /// times LayerSplat::lens_per_px. With lens moments, C x, W x, C y and W y follow, where (x, y) is the
    /// splat's position relative to the upper left corner of rows_.
    std::vector<double> sums_, changes_;
    std::vector<double> taps_;  ///< buffer of add()
};

}  // namespace postlens
