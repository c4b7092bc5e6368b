// Lists the point samples that contribute to the colour of one pixel.
#pragma once

#include <vector>

#include "records/record.h"
#include "records/sample_file.h"

namespace postlens {

/// A point sample of a pixel and its weight. The weights of all samples of a pixel add up to 1. `nodes` lists
/// the nodes of the visible surface's shading tree, beginning with its primary node. The nodes of hidden
/// surfaces follow.
struct PixelSample {
    float x = 0, y = 0;  ///< raster, px
    double weight = 0;
    std::vector<Record> nodes;
};

/// Returns the samples that contribute to pixel (x, y), row by row. They lie at the four corners of the pixel
/// and, if the pixel is subdivided, also on its sides and inside it. Throws Error(wrong_arguments) if the
/// pixel is not recorded.
[[nodiscard]] std::vector<PixelSample> pixel_samples(const SampleFileReader& file, int x, int y,
                                                     std::size_t instant = 0);

/// Finds the point sample nearest to a raster position, among those of the pixel that contains the position.
/// Returns z', the depth in metres, of its primary node. The depth is infinite if the ray of the sample hit
/// nothing.
[[nodiscard]] double depth_at(const SampleFileReader& file, double x, double y);

}  // namespace postlens
