// Rebuilds the quadtree into which each pixel was divided while it was traced. The file does not store the
// quadtree, but the positions of the samples at the corners of its cells determine it. The areas of the cells
// then give the weights of the samples in the pinhole image.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "records/record.h"

namespace postlens {

/// A point sample: one eye ray through the pinhole. It has one record for each surface that the ray and its
/// reflections and refractions hit. The records of one sample have the same raster position, so they are
/// adjacent in the sorted list of records: `record_count` records, from the index `first_record` on.
struct PointSample {
    float x = 0, y = 0;              ///< raster, px
    std::uint32_t first_record = 0;  ///< index into the band's records
    std::uint32_t record_count = 0;
    /// Weights of this sample. It is a corner of up to four quadtree cells: up-left, up-right, down-left and
    /// down-right of it. For each of these cells, the weight is a quarter of the cell's area, in px^2,
    /// because a cell has four corners. It is 0 if there is no such cell.
    std::array<float, 4> weight{};
    /// Edge length, in px, of the quadtree cells up-left, up-right, down-left and down-right of the sample; 0
    /// if there is none.
    std::array<float, 4> leaf_size{};
    [[nodiscard]] float total_weight() const { return weight[0] + weight[1] + weight[2] + weight[3]; }
};

/// Finds the point samples (eye rays) of rows y_begin to y_end - 1, and computes their weights (areas of the
/// image). The samples are listed pixel by pixel, and sorted by y, then by x.
///
/// A leaf (undivided quadtree cell) adds a quarter of its area to each sample at its corners. Only leaves in
/// pixel rows pixel_y_begin to pixel_y_end - 1 count. `band` must also contain rows y_begin - 1 and y_end if
/// they exist. Throws Error(invalid_input) if a corner of a cell has no sample.
struct PointSamples {
    std::vector<PointSample> samples;
    std::vector<std::uint32_t> offsets;  ///< per pixel of rows [y_begin, y_end), as in RecordBand
};
void find_point_samples(const RecordBand& band, int y_begin, int y_end, int pixel_y_begin, int pixel_y_end,
                        PointSamples& out);

/// A leaf (undivided cell) of a pixel's quadtree: a square with a point sample at each corner. `corner` lists
/// the samples in the order up-left, up-right, down-left, down-right.
struct Leaf {
    std::array<std::uint32_t, 4> corner{};  ///< indices into PointSamples::samples
    float size = 1;
};
/// The quadtree leaves of the pixels in rows y_begin to y_end - 1, pixel by pixel, and the point samples at
/// their corners. The leaves of pixel (x, y) have the indices leaf_offsets[k] to leaf_offsets[k + 1] - 1,
/// where k = (y - y_begin) * band.width() + x - band.x_begin. The last column of the band has no leaves,
/// because it contains only corners.
///
/// `points` holds the samples of rows y_begin to y_end inclusive, which `band` must contain. They are in the
/// order of find_point_samples and have no weights. Throws Error(invalid_input) if a corner of a quadtree
/// cell is missing.
struct PixelLeaves {
    PointSamples points;
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> leaf_offsets;
};
void find_leaves(const RecordBand& band, int y_begin, int y_end, PixelLeaves& out);

/// Computes row y of the pinhole image, for columns x_begin to x_end - 1. `band` must contain row y of the
/// samples and the next row, because the pixels' corners lie in both. A leaf (undivided cell) of a pixel's
/// quadtree has the mean colour of the samples at its four corners. A pixel has the mean colour of its
/// leaves, weighted by area. Sums are in double precision and in a fixed order, so results are bit-identical
/// on all machines.
void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb);

}  // namespace postlens
