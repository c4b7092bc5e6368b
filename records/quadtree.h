// Rebuilds the quadtree of each pixel from the positions of its samples, and computes from it the weights of
// the samples and the pinhole image.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "records/record.h"

namespace postlens {

/// A point sample of layer 0: consecutive records (its nodes) with the same x, y.
struct PointSample {
    float x = 0, y = 0;              ///< raster, px
    std::uint32_t first_record = 0;  ///< index into the band's records
    std::uint32_t record_count = 0;
    /// Weight of the sample, by the quadrant around its position: [0] up-left, [1] up-right, [2] down-left,
    /// [3] down-right. Every leaf with a corner at the sample adds a quarter of its area to the quadrant it
    /// lies in. The weight in a pixel is the sum of the quadrants that lie in this pixel.
    std::array<float, 4> weight{};
    /// Edge length of the leaf in that quadrant, px; 0 if there is none (outside the raster, or a sample on
    /// the edge of a larger leaf).
    std::array<float, 4> leaf_size{};
    [[nodiscard]] float total_weight() const { return weight[0] + weight[1] + weight[2] + weight[3]; }
};

/// Point samples of the pixel rows [y_begin, y_end) of `band`, row by row, sorted by (y, x) within a pixel.
/// Weights refer to the pixels [x_begin, x_end - 1) x [pixel_y_begin, pixel_y_end), which have corners on all
/// four sides. `band` must also hold row y_begin - 1 (for the pixels above) and row y_end (lower corners)
/// where such pixels exist. Throws Error(invalid_input) if a corner of a quadtree is missing.
struct PointSamples {
    std::vector<PointSample> samples;
    std::vector<std::uint32_t> offsets;  ///< per pixel of rows [y_begin, y_end), as in RecordBand
};
void find_point_samples(const RecordBand& band, int y_begin, int y_end, int pixel_y_begin, int pixel_y_end,
                        PointSamples& out);

/// A leaf of a pixel's quadtree: a square of `size` px with point samples at its corners, in the order
/// up-left, up-right, down-left, down-right.
struct Leaf {
    std::array<std::uint32_t, 4> corner{};  ///< indices into PointSamples::samples
    float size = 1;
};
/// Leaves of the pixels [x_begin, x_end - 1) x [y_begin, y_end) of `band`, pixel by pixel, and the point
/// samples at their corners: those of rows y_begin to y_end inclusive, which `band` must hold, in the order
/// of find_point_samples but without weights. Pixel k has the leaves [leaf_offsets[k], leaf_offsets[k + 1]);
/// k counts the whole width of the band, whose last column has no leaves. Throws Error(invalid_input) if a
/// corner of a quadtree is missing.
struct PixelLeaves {
    PointSamples points;
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> leaf_offsets;
};
void find_leaves(const RecordBand& band, int y_begin, int y_end, PixelLeaves& out);

/// Pixel row y, columns [x_begin, x_end), of the pinhole image computed from the records. A pixel is the
/// area-weighted mean over its leaves of the mean of each leaf's corners, summed in double precision in a
/// fixed order, so that results are bit-identical everywhere. `band` must hold rows y and y + 1.
void picture_row(const RecordBand& band, int y, int x_begin, int x_end, std::span<float> rgb);

}  // namespace postlens
