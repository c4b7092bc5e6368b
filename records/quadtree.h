// Rebuilds the quadtree into which each pixel was divided while it was traced. The file does not store the
// quadtree, but a sample at each corner of its cells. A cell was divided if it has a sample at its centre.
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
/// reflections and refractions hit. They are adjacent in the sorted list of records.
struct PointSample {
    float x = 0, y = 0;              ///< raster, px
    std::uint32_t first_record = 0;  ///< index into the band's records
    std::uint32_t record_count = 0;
    /// Weights of this sample for the quadtree cells of which it is a corner: up-left, up-right, down-left
    /// and down-right of it. A weight is a quarter of the cell's area, in px^2, or 0 if there is no such
    /// cell.
    std::array<float, 4> weight{};
    /// Widths, in px, of the quadtree cells up-left, up-right, down-left and down-right of this sample. A
    /// width is 0 if there is no such cell.
    std::array<float, 4> leaf_size{};
    [[nodiscard]] float total_weight() const { return weight[0] + weight[1] + weight[2] + weight[3]; }
};

/// Finds the point samples (eye rays) that are stored in the rows y_begin to y_end - 1 of `band`, and
/// computes their weights. A leaf (undivided quadtree cell) adds a quarter of its area to the weight of each
/// sample at its corners. Only leaves in the pixel rows pixel_y_begin to pixel_y_end - 1 are counted. The
/// samples are listed pixel by pixel, and sorted by y, then by x.
///
/// `band` must also contain the rows y_begin - 1 and y_end if they exist, because the other corners of the
/// leaves may lie there. Throws Error(invalid_input) if a corner of a cell has no sample.
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

/// Computes row y of the pinhole image, for the columns x_begin to x_end - 1. `band` must contain the rows y
/// and y + 1 of the samples, because the upper corners of the pixels are stored in row y and the lower
/// corners in row y + 1. A pixel's colour is the mean of its quadtree's leaves (undivided cells), weighted by
/// area. A leaf's colour is the mean of the samples at its four corners. Sums are in double precision and in
/// a fixed order, so results are bit-identical on all machines.
void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb);

}  // namespace postlens
