// Range of depths in each pixel of a sample file, and the pixels in which `focus` is reliable.
#pragma once

#include <vector>

#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

/// Range of the inverse depths, 1/m, of the primary visible nodes in each pixel and on its border, row by
/// row.
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

/// 1 for pixels that receive no light from the neighbourhood of a depth edge or from beyond the recorded
/// area. No hidden surface is disoccluded there and no light is missing, so that `focus` is as accurate as
/// its samples. A depth edge is a pixel over which the CoC's diameter changes by 1 px or more; its light
/// reaches as far as the larger of its CoC radii.
[[nodiscard]] std::vector<char> reliable_pixels(const RecordedDepths& depths, const FocusGeometry& geometry);

}  // namespace postlens
