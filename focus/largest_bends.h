// Finds by how much linear reprojection to other lens points misplaces the surfaces of each pixel: the
// largest Record::w_bend, in 1/m^2.
#pragma once

#include <vector>

#include "records/sample_file.h"

namespace postlens {

/// Smallest radiance that an image of 8 bits per channel shows.
inline constexpr float darkest_shown = 1.0F / 255;

/// For each pixel of the pinhole image, the largest w_bend of the surface samples that it shows. The position
/// of a sample, seen from another lens point, is extrapolated linearly from the lens's centre. w_bend, in
/// 1/m^2, measures the error of this position. For an aperture of the diameter D, the error in px is at most:
///
///     (film distance / pixel pitch) w_bend (D / 2)^2
class LargestBends {
  public:
    /// Allocates one value per pixel, the largest w_bend, for the image rows [y_begin, y_end). All values are
    /// 0 until add() is called. The image is the one that `header` describes, without the overscan.
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
