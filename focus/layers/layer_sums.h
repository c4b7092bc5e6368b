// Sums of the splats (impulse responses) of one LayerPart over a block of pixels.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// Sums of colour, weight and depth, each multiplied by the kernel. The cost of a splat is proportional to
/// the length of its kernel's outline, because the uniform interior of a kernel row is stored as differences
/// between neighbouring pixels (as in PointScatter). Adjacent splats that share a kernel (most splats of
/// another program's image) are added together, row by row, in a third of the time. Rows without an interior
/// are added directly, because the lens moments of small kernels are large, and the rounding errors of their
/// differences would reach all pixels to the right.
class LayerSums {
  public:
    /// Sets the sums of the pixels of `rows` to 0. `with_lens`: lens moments are summed as well.
    /// `from_anchor_px`: distance of samples from their anchors, to the right and down.
    void begin(const RasterWindow& rows, bool with_lens, double from_anchor_px = 0);
    /// Adds splats with the kernels of one channel.
    void add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel);
    /// Adds up the differences along each row to get the sums. Call it after the last splat.
    void finish();

    [[nodiscard]] const RasterWindow& rows() const { return rows_; }
    /// Sums of red, green, blue and weight at a pixel.
    [[nodiscard]] const double* at(int x, int y) const { return sums_.data() + index(x, y) * stride_; }
    [[nodiscard]] double depth_at(int x, int y) const { return at(x, y)[stride_ - 2]; }
    [[nodiscard]] double covered_at(int x, int y) const { return at(x, y)[stride_ - 1]; }
    /// The lens moments of the sums that `at` returns: each term is multiplied by the lens point of its
    /// light, in lens radii.
    [[nodiscard]] std::array<LensMoment, 4> lens_at(int x, int y) const;

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rows_.y_begin) * width_ +
               static_cast<std::size_t>(x - rows_.x_begin);
    }

    RasterWindow rows_;
    bool with_lens_ = false;
    double from_anchor_px_ = 0;
    std::size_t width_ = 0;   ///< pixels per row of the buffers: rows_ plus one, for the last difference
    std::size_t stride_ = 6;  ///< values per pixel
    /// Values of each pixel: [0..3] red, green, blue and weight. With lens moments, also: [4..7] the first
    /// four times LayerSplat::lens_per_px; [8..11] these products times the anchor's x, counted from the
    /// corner of rows_; [12..15] the products times its y. The last two values are depth and covered weight.
    std::vector<double> sums_, changes_;
    std::vector<double> taps_;  ///< buffer of add()
};

}  // namespace postlens
