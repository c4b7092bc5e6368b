// The quadtree of each pixel, rebuilt from its samples, and what follows from it: weights and the pinhole
// picture.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "records/image.h"
#include "records/record.h"

namespace postlens {

/// A point sample of layer 0: a run of records (its nodes) that share x, y.
struct PointSample {
    float x = 0, y = 0;              ///< raster, px
    std::uint32_t first_record = 0;  ///< index into the band's records
    std::uint32_t record_count = 0;
    /// Weight in each pixel it touches: [0] up-left, [1] up-right, [2] down-left, [3] down-right of the
    /// position. A sample inside a pixel, or on an edge of it, has the sum over quadrants that lie in that
    /// pixel split by quadrant; so the weight in pixel p is the sum of the quadrants that lie in p. Leaf area
    /// / 4 per touching leaf.
    std::array<float, 4> weight{};
    /// Edge length, px, of the leaf in that quadrant; 0 where no leaf is there (outside the raster, hanging
    /// node).
    std::array<float, 4> leaf_size{};
    [[nodiscard]] float total_weight() const { return weight[0] + weight[1] + weight[2] + weight[3]; }
};

/// The point samples of pixel rows [y_begin, y_end) of `band`, row by row, sorted by (y, x) within a pixel,
/// with the weights that they have in pixels of [x_begin, x_end - 1) x [pixel_y_begin, pixel_y_end): the
/// pixels that own corners on all four sides. Needs in `band` the rows from y_begin - 1 (for the pixels
/// above) and y_end (lower corners), where such pixels exist. Throws Error(invalid_input) on a quadtree with
/// missing corners.
struct PointSamples {
    std::vector<PointSample> samples;
    std::vector<std::uint32_t> offsets;  ///< per pixel of the rows asked for, as in RecordBand
};
void find_point_samples(const RecordBand& band, int y_begin, int y_end, int pixel_y_begin, int pixel_y_end,
                        PointSamples& out);

/// A leaf of a pixel's quadtree: a square of `size` px whose corners are the point samples up-left, up-right,
/// down-left, down-right.
struct Leaf {
    std::array<std::uint32_t, 4> corner{};  ///< indices into PointSamples::samples
    float size = 1;
};
/// The leaves of the pixels [x_begin, x_end - 1) x [y_begin, y_end) of `band`, pixel by pixel, and their
/// point samples: of the rows from y_begin to y_end inclusive, as find_point_samples lists them but without
/// weights. `band` must hold those rows. Leaves of pixel k of the rows are [leaf_offsets[k], leaf_offsets[k +
/// 1]), the pixels counted with the band's whole width (the last column has none). Throws
/// Error(invalid_input) on a quadtree with missing corners.
struct PixelLeaves {
    PointSamples points;
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> leaf_offsets;
};
void find_leaves(const RecordBand& band, int y_begin, int y_end, PixelLeaves& out);

/// The traced picture of pixel row y, columns [x_begin, x_end) of the raster, from the records alone: the
/// mean over the quadtree's leaves of the mean of each leaf's corners, summed in double in a fixed order, so
/// that the result is the same bits wherever it is computed. `band` must hold rows y and y + 1.
void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb);

}  // namespace postlens
