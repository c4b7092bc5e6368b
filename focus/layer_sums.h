// Sums of the splats of one part of a surface over some pixels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "focus/layer_splats.h"

namespace postlens {

/// Colour, weight and depth times response. Each splat costs as much as its outline: as in PointScatter, the
/// inside of a response is added as a difference where a row of it begins and ends.
class LayerSums {
  public:
    /// Nothing over the pixels of `rows`. Buffers are kept from call to call.
    void begin(const RasterWindow& rows);
    /// Adds splats by the kernels of one channel.
    void add(std::span<const LayerSplat> splats, const KernelTable& kernels, std::size_t channel);
    /// Makes sums of the differences; after the last splat.
    void finish();

    [[nodiscard]] const RasterWindow& rows() const { return rows_; }
    /// Red, green, blue and weight at a pixel of the rows.
    [[nodiscard]] const double* at(int x, int y) const { return sum_.data() + 4 * index(x, y); }
    [[nodiscard]] double depth_at(int x, int y) const { return depth_[index(x, y)]; }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rows_.y_begin) * stride_ +
               static_cast<std::size_t>(x - rows_.x_begin);
    }

    RasterWindow rows_;
    std::size_t stride_ = 0;  ///< pixels from row to row: one more than there are, for what ends there
    std::vector<double> sum_, change_;  ///< red, green, blue, weight
    std::vector<double> depth_, depth_change_;
};

}  // namespace postlens
