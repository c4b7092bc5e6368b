// The range of depths in each pixel of a sample file. Where it is narrow, a simple simulation of blur is
// reliable.
#pragma once

#include <vector>

#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

/// Range of depths in each pixel, stored as inverse depths in 1/m, row by row. For each pixel, it contains
/// all surfaces that the pinhole sees directly in the pixel or on its border. Surfaces that are seen by
/// reflection or refraction are not included.
struct RecordedDepths {
    int width = 0, height = 0, overscan_px = 0;
    std::vector<float> nearest_per_m, farthest_per_m;  ///< largest and smallest; 0 where nothing was hit

    [[nodiscard]] double nearest() const;   ///< largest inverse depth of all pixels, 1/m
    [[nodiscard]] double farthest() const;  ///< smallest inverse depth of all pixels, 1/m
    /// Returns the largest circle of confusion over all pixels, in px.
    [[nodiscard]] double largest_coc_px(const FocusGeometry& geometry) const;
};

/// Throws Error(invalid_input) for a damaged file.
[[nodiscard]] RecordedDepths recorded_depths(const SampleFileReader& file);

/// Returns one flag per pixel: 1 if the blur computed from the recorded surfaces is reliable there, otherwise
/// 0. The blur is unreliable in a pixel if light is blurred into it from outside the area that the sample
/// file contains, or from a depth edge: a pixel whose nearest and farthest depths have circles of confusion
/// that differ by 1 px or more.
[[nodiscard]] std::vector<char> reliable_pixels(const RecordedDepths& depths, const FocusGeometry& geometry);

}  // namespace postlens
