// Lists the point samples that contribute to the colour of one pixel.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample (one eye ray) of a pixel, with its weight in the pixel's colour. The weights of all samples
/// of a pixel add up to 1. `nodes` contains one record for each surface that the ray and its reflections and
/// refractions hit, and then one for each hidden surface behind these.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    std::vector<Record> nodes;
};

/// Returns the samples that contribute to pixel (x, y), sorted by y, then by x. They lie at its corners and,
/// if it is subdivided, also on its sides and inside. Throws Error(wrong_arguments) if the pixel is not
/// recorded.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// Returns the depth, in metres, that the pinhole sees at the raster position (x, y). It is that of the point
/// sample in the same pixel that is closest to (x, y). It is infinite if this sample's ray hit nothing.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
