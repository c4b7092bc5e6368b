// Sums of the splats of one part of a surface over some pixels.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "focus/layer_splats.h"
#include "focus/visibility.h"

namespace postlens {

/// Colour, weight and depth times response. Each splat costs as much as its outline: as in PointScatter, the
/// inside of a response is added as a difference where a row of it begins and ends.
class LayerSums {
  public:
    /// Nothing over the pixels of `rows`. `with_lens`: lens points are summed up, too. Buffers are kept from
    /// call to call.
    /// `from_anchor_px`: where samples stand, right of and below their anchors.
    void begin(const RasterWindow& rows, bool with_lens, double from_anchor_px = 0);
    /// Adds splats by the kernels of one channel.
    void add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel);
    /// Makes sums of the differences; after the last splat.
    void finish();

    [[nodiscard]] const RasterWindow& rows() const { return rows_; }
    /// Red, green, blue and weight at a pixel of the rows.
    [[nodiscard]] const double* at(int x, int y) const { return sum_.data() + index(x, y) * stride_; }
    [[nodiscard]] double depth_at(int x, int y) const { return depth_[index(x, y)]; }
    [[nodiscard]] double covered_at(int x, int y) const { return covered_[index(x, y)]; }
    /// The same as `at`, each times the lens point (x and y, in radii of the lens) that it came through.
    [[nodiscard]] std::array<LensMoment, 4> lens_at(int x, int y) const;

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rows_.y_begin) * width_ +
               static_cast<std::size_t>(x - rows_.x_begin);
    }

    RasterWindow rows_;
    bool with_lens_ = false;
    double from_anchor_px_ = 0;
    std::size_t width_ = 0;   ///< pixels from row to row: one more than there are, for what ends there
    std::size_t stride_ = 4;  ///< numbers from pixel to pixel
    /// By pixel: red, green, blue, weight; with lens points these also times lens_per_px, and that times x
    /// and y of the anchor, from the corner of the rows.
    std::vector<double> sum_, change_;
    std::vector<double> depth_, depth_change_, covered_, covered_change_;
};

}  // namespace postlens
