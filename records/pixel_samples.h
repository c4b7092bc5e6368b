// Lists the point samples (eye rays) of a sample file that contribute to the colour of one pixel of the
// pinhole image.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample (one eye ray) of a pixel, with its weight in the pixel's colour. The weights of all samples
/// of a pixel add up to 1.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    /// One record for each surface that the ray and its reflections and refractions hit, and then one for
    /// each hidden surface behind these.
    std::vector<Record> nodes;
};

/// Returns the samples (eye rays) that contribute to the colour of pixel (x, y), sorted by y, then by x. They
/// lie at the corners of the pixel and of its quadtree cells. Throws Error(wrong_arguments) if the pixel is
/// not recorded.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// Returns the depth, in metres, that the pinhole sees at the raster position (x, y). It is that of the point
/// sample in the same pixel that is closest to (x, y). It is infinite if this sample's ray hit nothing.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
