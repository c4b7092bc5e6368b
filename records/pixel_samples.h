// Lists the point samples that contribute to the colour of one pixel.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample of a pixel and its weight in that pixel; all weights of a pixel add up to 1. `nodes`
/// contains its shading trees: that of the visible layer, primary node first, then those of the hidden
/// layers.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    std::vector<Record> nodes;
};

/// Returns the samples of pixel (x, y), row by row: those at its four corners and, if the pixel is
/// subdivided, those inside and on its sides. Throws Error(wrong_arguments) if the pixel is not recorded.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// z' of the primary node nearest to the given raster position, m; infinite if its ray hit nothing.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
