// Lists the point samples that contribute to one pixel.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample of a pixel, its weight in that pixel (all weights add up to 1) and its shading trees: the
/// visible layer, primary node first, then the hidden layers.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    std::vector<Record> nodes;
};

/// Samples of pixel (x, y), row by row: those at its four corners and, if it is subdivided, those inside and
/// on its sides. Throws Error(wrong_arguments) outside the recorded pixels.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// z' of the primary node nearest to a raster position, m; infinite if nothing was hit.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
