// Sums the blurred samples of one surface, or of one mirror image, over a block of pixels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "focus/layers/layer_splats.h"
#include "focus/layers/visibility.h"

namespace postlens {

/// Sums over the blurred samples of one surface, for each pixel of a block of the image. The colour, weight
/// and depth of each sample are multiplied by its blur kernel and added.
///
/// The uniform interior of a blur kernel is stored as differences between neighbouring pixels. Therefore, the
/// time for a sample is proportional to the length of the kernel's outline, not to its area.
class LayerSums {
  public:
    /// Number of values that are summed for each pixel, for example red, green, blue and weight. There are 8,
    /// which fill an AVX-512 register, or 12 if it is also summed through which side of the lens the light
    /// arrives (lens_at()).
    static constexpr std::size_t plain_values = 8, lens_values = 12;

    /// Allocates the sums of blurred light for all pixels in `rows`, and sets them to 0.
    /// - `with_lens`: whether to compute also the sums for lens_at(), which returns 0 otherwise
    /// - `from_anchor_px`: distance of each sample from the top left corner of its pixel, along x and y: 0,
    ///   or 0.5 if samples lie at pixel centres
    void begin(const RasterWindow& rows, bool with_lens, double from_anchor_px = 0);
    void add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel);
    /// Completes the sums of all pixels, by summing up the stored differences along each row. Call it after
    /// the last add() and before reading the sums.
    void finish();

    [[nodiscard]] const RasterWindow& rows() const { return rows_; }
    /// Returns four sums over the blurred samples at a pixel: red, green, blue and weight. The sum of the
    /// weights is the fraction of the pixel that the samples cover, but may exceed 1. The colour of each
    /// sample is multiplied by its weight.
    [[nodiscard]] const double* at(int x, int y) const { return sums_.data() + index(x, y) * stride_; }
    [[nodiscard]] double depth_at(int x, int y) const { return at(x, y)[4]; }
    [[nodiscard]] double covered_at(int x, int y) const { return at(x, y)[5]; }
    /// Tells through which side of the lens the blurred light at a pixel arrives. Returns two sums, over all
    /// samples that reach the pixel, of their mean lens points, in lens radii. Lens points are weighted with
    /// red + green + blue in `rgb`, and with the sample's weight in `alpha`.
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
    std::vector<double> sums_, changes_;
    std::vector<double> taps_;  ///< buffer of add()
};

}  // namespace postlens
