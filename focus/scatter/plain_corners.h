// Plain corners: samples at corners of undivided pixels, without reflections and refractions. Most samples of
// a frame are plain corners, and are therefore stored compactly, as arrays of depth, r, g and b.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Whether a sample lies at a pixel corner and none of the four pixels around it is divided.
[[nodiscard]] inline bool is_whole_corner(const PointSample& s) {
    return s.weight == std::array<float, 4>{0.25F, 0.25F, 0.25F, 0.25F};
}
[[nodiscard]] inline bool is_dark(const Record& node) {
    return node.r == 0 && node.g == 0 && node.b == 0;
}

/// The plain corners of some rows, row by row of the band's width. A plain corner has weight 1 and radiance
/// only at the first surface. Corners on the border of the raster have less than the weight of four pixels,
/// so they are never plain.
struct PlainCorners {
    /// 1/z' of the corner at each column, 1/m; `not_plain` for other corners.
    std::vector<double> inverse_depth;
    std::vector<float> r, g, b;  ///< as inverse_depth; 0 for other corners
    /// All other point samples, as indices into PointSamples::samples, in order. Row i has the elements
    /// [other_begin[i], other_begin[i + 1]) of `others`.
    std::vector<std::uint32_t> others, other_begin;
    /// The range of depths of a row's plain corners, and whether any of them has a negative colour.
    struct Row {
        /// Smallest and largest 1/z' of corners at a finite depth, 1/m. If there are no such corners, least >
        /// greatest.
        double least_inverse = std::numeric_limits<double>::infinity(), greatest_inverse = 0;
        bool negative = false;  ///< some colour is negative
    };
    std::vector<Row> rows;

    static constexpr double not_plain = -1;
};

/// Finds the plain corners of those rows of `band` that `samples` has. Reuses the memory of `out`.
void find_plain_corners(const RecordBand& band, const PointSamples& samples, PlainCorners& out);

}  // namespace postlens
