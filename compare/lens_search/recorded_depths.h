// The range of depths in each pixel of a sample file. It determines in which pixels the simulated lens blur
// (`focus`) is reliable.
#pragma once

#include <vector>

#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

/// Range of inverse depths (1/m) of the directly visible surfaces in each pixel and on the pixel's border.
/// There is one entry per pixel, row by row.
struct RecordedDepths {
    int width = 0, height = 0, overscan_px = 0;
    std::vector<float> nearest_per_m, farthest_per_m;  ///< largest and smallest; 0 where nothing was hit

    [[nodiscard]] double nearest() const;   ///< largest inverse depth of all pixels, 1/m
    [[nodiscard]] double farthest() const;  ///< smallest inverse depth of all pixels, 1/m
    /// Returns the largest diameter of a circle of confusion (CoC) over all pixels, in px.
    [[nodiscard]] double largest_coc_px(const FocusGeometry& geometry) const;
};

/// Throws Error(invalid_input) for a damaged file.
[[nodiscard]] RecordedDepths recorded_depths(const SampleFileReader& file);

/// Returns 1 for each pixel in which the simulated lens blur (`focus`) is reliable, and 0 for the others. A
/// reliable pixel receives light neither from a depth edge nor from outside the recorded area. A depth edge
/// is a pixel within which the diameter of the circle of confusion (CoC) varies by 1 px or more. Such a pixel
/// spreads its light as far as the largest CoC radius within it.
[[nodiscard]] std::vector<char> reliable_pixels(const RecordedDepths& depths, const FocusGeometry& geometry);

}  // namespace postlens
