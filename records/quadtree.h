// Rebuilds the quadtree of each pixel from the positions of its samples. Computes the weights of the samples
// and the pinhole image from the quadtree.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "records/record.h"

namespace postlens {

/// A point sample of layer 0 (what the pinhole sees): consecutive records with the same x and y. They are the
/// nodes of one shading tree.
struct PointSample {
    float x = 0, y = 0;              ///< raster, px
    std::uint32_t first_record = 0;  ///< index into the band's records
    std::uint32_t record_count = 0;
    /// Weight of the sample in each quadrant around its position: [0] up-left, [1] up-right, [2] down-left,
    /// [3] down-right. Every leaf (undivided cell) with a corner at the sample adds a quarter of its area to
    /// the quadrant that contains the leaf. The weight in a pixel is the sum over the quadrants inside the
    /// pixel.
    std::array<float, 4> weight{};
    /// Edge length, px, of the leaf that has a corner at the sample, for each of the four quadrants around
    /// the sample (in the order of `weight`). 0 if there is no such leaf: the quadrant is outside the raster,
    /// or the sample lies on an edge of a larger leaf.
    std::array<float, 4> leaf_size{};
    [[nodiscard]] float total_weight() const { return weight[0] + weight[1] + weight[2] + weight[3]; }
};

/// Finds the point samples of the pixel rows [y_begin, y_end) of `band`, and their weights. Samples are
/// listed pixel by pixel, and within a pixel by y, then by x. A sample gets weights from the leaves of all
/// pixels around it in the columns [x_begin, x_end - 1) and the rows [pixel_y_begin, pixel_y_end), because
/// all corners of these pixels are recorded. The weights of row y_begin need the pixels of row y_begin - 1.
/// The lower corners of row y_end - 1 are stored in row y_end. If these two rows exist, `band` must contain
/// them. Throws Error(invalid_input) if a corner of a quadtree is missing.
struct PointSamples {
    std::vector<PointSample> samples;
    std::vector<std::uint32_t> offsets;  ///< per pixel of rows [y_begin, y_end), as in RecordBand
};
void find_point_samples(const RecordBand& band, int y_begin, int y_end, int pixel_y_begin, int pixel_y_end,
                        PointSamples& out);

/// A leaf (undivided cell) of a pixel's quadtree: a square of `size` px with point samples at its corners.
/// The corners are in the order up-left, up-right, down-left, down-right.
struct Leaf {
    std::array<std::uint32_t, 4> corner{};  ///< indices into PointSamples::samples
    float size = 1;
};
/// The quadtree leaves of the pixel rows [y_begin, y_end) of `band`, pixel by pixel, and the point samples at
/// their corners. Pixel (x, y) has the leaves [leaf_offsets[k], leaf_offsets[k + 1]) with k = (y - y_begin) *
/// band.width() + x - band.x_begin. The last column of the band contains only corners and no leaves, but is
/// counted in k. `points` contains the samples of rows y_begin to y_end inclusive, in the order of
/// find_point_samples but without weights. `band` must contain these rows. Throws Error(invalid_input) if a
/// corner of a quadtree is missing.
struct PixelLeaves {
    PointSamples points;
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> leaf_offsets;
};
void find_leaves(const RecordBand& band, int y_begin, int y_end, PixelLeaves& out);

/// Computes pixel row y, columns [x_begin, x_end), of the pinhole image from the records. Each leaf of a
/// pixel has the mean colour of its four corners; the pixel is the area-weighted mean of its leaves. Sums are
/// in double precision and in a fixed order, so results are bit-identical on all machines. `band` must
/// contain rows y and y + 1.
void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb);

}  // namespace postlens
