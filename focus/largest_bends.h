// Finds for each pixel how wrong the positions of its surfaces may be when they are drawn from another lens
// point. Surfaces are moved linearly with the lens point, but their true motion in curved mirrors and glass
// is nonlinear.
#pragma once

#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Smallest radiance that an image of 8 bits per channel shows.
inline constexpr float darkest_shown = 1.0F / 255;

/// For each pixel of the pinhole image, the largest error of its surfaces' positions when they are drawn from
/// another lens point. They are moved linearly with the lens point, but their true motion is nonlinear.
/// Record::w_bend, in 1/m^2, describes the difference. For an aperture of the diameter D, the error in px is
/// at most:
///
///     (film distance / pixel pitch) w_bend (D / 2)^2
class LargestBends {
  public:
    /// Allocates one value for each pixel of the image rows [y_begin, y_end), and sets it to 0. add() then
    /// computes the values, each of which is the largest w_bend in a pixel. `header` describes the image;
    /// overscan does not belong to it.
    LargestBends(const SampleHeader& header, int y_begin, int y_end);
    /// Sets the values of the image rows [y_begin, y_end) from their surface samples, in parallel. `band` has
    /// the records of the sample file in these rows. Rows for which the constructor has allocated no values
    /// are skipped.
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
