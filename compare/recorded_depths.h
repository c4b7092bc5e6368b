// Which depths every pixel of a sample file shows, and where `focus` can be relied on.
#pragma once

#include <vector>

#include "lens/focus_geometry.h"
#include "records/sample_file.h"

namespace postlens {

/// Inverse depths, 1/m, of the primary visible nodes in each pixel and on its border, row by row.
struct RecordedDepths {
    int width = 0, height = 0, overscan_px = 0;
    std::vector<float> nearest_per_m, farthest_per_m;  ///< farthest <= nearest; 0 where nothing was hit

    [[nodiscard]] double nearest() const;   ///< of all pixels
    [[nodiscard]] double farthest() const;  ///< of all pixels
    /// Largest CoC diameter over the pixels, px.
    [[nodiscard]] double largest_coc_px(const FocusGeometry& geometry) const;
};

/// Throws Error(invalid_input) for a damaged file.
[[nodiscard]] RecordedDepths recorded_depths(const SampleFileReader& file);

/// 1 for the pixels that no light from the neighbourhood of a depth edge reaches, nor any from beyond the
/// records: there, nothing hidden comes into view and nothing is missing, so `focus` is as right as its
/// samples are. A depth edge is a pixel over which the CoC's diameter changes by a pixel or more; light goes
/// as far as its larger radius.
[[nodiscard]] std::vector<char> reliable_pixels(const RecordedDepths& depths, const FocusGeometry& geometry);

}  // namespace postlens
