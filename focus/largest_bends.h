// Finds, for each pixel, by how much linear reprojection to other lens points misplaces the pixel's surfaces:
// the largest w_bend, in 1/m^2.
#pragma once

#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Smallest radiance that an image of 8 bits per channel shows.
inline constexpr float darkest_shown = 1.0F / 255;

/// For each pixel, the largest w_bend of the recorded surfaces that the pinhole image shows. w_bend, in
/// 1/m^2, measures how wrong the position of a surface sample is when it is extrapolated linearly to another
/// lens point. For an aperture of diameter D, the error in px is at most:
///
///     (film distance / pixel pitch) w_bend (D / 2)^2
class LargestBends {
  public:
    /// Allocates the values of the image rows [y_begin, y_end), one per pixel. The image is the one that
    /// `header` describes, without the overscan.
    LargestBends(const SampleHeader& header, int y_begin, int y_end);
    /// Adds the samples of the image rows [y_begin, y_end), in parallel. Rows outside the range given to the
    /// constructor are skipped.
    void add(const RecordBand& band, int y_begin, int y_end);
    [[nodiscard]] bool covers(int y_begin, int y_end) const { return y_begin >= y_begin_ && y_end <= y_end_; }
    [[nodiscard]] const float* row(int y) const {
        return values_.data() + static_cast<std::size_t>(y - y_begin_) * static_cast<std::size_t>(width_);
    }

  private:
    int width_, y_begin_, y_end_;
    std::vector<float> values_;
};

}  // namespace postlens
