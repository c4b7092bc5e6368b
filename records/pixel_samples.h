// One pixel under the magnifying glass: every point sample that its value is made of.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample of a pixel, its weight in that pixel (they add up to 1) and its shading trees: what is
/// visible, primary node first, then the hidden layers.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    std::vector<Record> nodes;
};

/// The samples of pixel (x, y): its four corners and, where it is subdivided, those inside and on its sides;
/// by rows. Throws Error(wrong_arguments) outside the recorded pixels.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// z' of the primary node nearest to a raster position, m; infinite where nothing was hit.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
