// Stores the most common kind of samples, plain samples, compactly: as arrays of depth, red, green and blue.
// These samples have no reflections or refractions. Each of them lies at the common corner of four pixels
// that are not divided into smaller quadtree cells.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Returns whether a sample lies at the corner of four pixels that are not divided into smaller quadtree
/// cells. It then represents a quarter of each pixel.
[[nodiscard]] inline bool is_whole_corner(const PointSample& s) {
    return s.weight == std::array<float, 4>{0.25F, 0.25F, 0.25F, 0.25F};
}
[[nodiscard]] inline bool is_dark(const Record& node) {
    return node.r == 0 && node.g == 0 && node.b == 0;
}

/// The plain samples of some rows, stored compactly. A sample is plain if it shows no reflections and lies at
/// the common corner of four pixels, none of which the quadtree divides into smaller cells. The arrays have
/// one element per pixel corner, row by row.
struct PlainCorners {
    /// Inverse depth, in 1/m, of the sample at each pixel corner. If the sample shows reflections, or one of
    /// its four pixels is divided by the quadtree, the sample is not plain, and the value is `not_plain`.
    std::vector<double> inverse_depth;
    std::vector<float> r, g, b;  ///< as inverse_depth; 0 for other corners
    /// The samples that are not plain, because they show reflections or touch a pixel that the quadtree
    /// divides. They are given by their indices in PointSamples::samples, row by row. Those of row i begin at
    /// others[other_begin[i]].
    std::vector<std::uint32_t> others, other_begin;
    /// Summary of the samples that are stored for a row.
    struct Row {
        double least_inverse = std::numeric_limits<double>::infinity(), greatest_inverse = 0;
        bool negative = false;  ///< some colour is negative
    };
    std::vector<Row> rows;

    static constexpr double not_plain = -1;
};

/// Finds the plain samples among `samples`, and stores them in `out`, whose memory is reused. A sample is
/// plain if it shows no reflections and lies at the common corner of four undivided pixels. `band` contains
/// the records (surface points) of all samples.
void find_plain_corners(const RecordBand& band, const PointSamples& samples, PlainCorners& out);

}  // namespace postlens
