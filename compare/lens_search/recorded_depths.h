// The range of depths in each pixel of a sample file. It determines the pixels in which `focus` is reliable.
#pragma once

#include <vector>

#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

/// The range of inverse depths, 1/m, of the surfaces that are seen directly in each pixel and on its border.
/// One entry per pixel, row by row.
struct RecordedDepths {
    int width = 0, height = 0, overscan_px = 0;
    std::vector<float> nearest_per_m, farthest_per_m;  ///< farthest <= nearest; 0 where nothing was hit

    [[nodiscard]] double nearest() const;   ///< largest inverse depth of all pixels, 1/m
    [[nodiscard]] double farthest() const;  ///< smallest inverse depth of all pixels, 1/m
    /// Largest CoC diameter over the pixels, px.
    [[nodiscard]] double largest_coc_px(const FocusGeometry& geometry) const;
};

/// Throws Error(invalid_input) for a damaged file.
[[nodiscard]] RecordedDepths recorded_depths(const SampleFileReader& file);

/// Returns 1 for the pixels that receive no light from near a depth edge or from beyond the recorded area. In
/// these pixels no hidden surface becomes visible and no light is missing, so `focus` is as accurate as the
/// samples. A depth edge is a pixel within which the diameter of the circle of confusion (CoC) changes by 1
/// px or more. The light of such a pixel reaches as far as the larger of its CoC radii.
[[nodiscard]] std::vector<char> reliable_pixels(const RecordedDepths& depths, const FocusGeometry& geometry);

}  // namespace postlens
