// The corner samples that ask nothing but their own depth of a lens, plane by plane: most of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// A corner whose four pixels are not divided.
[[nodiscard]] inline bool is_whole_corner(const PointSample& s) {
    return s.weight == std::array<float, 4>{0.25F, 0.25F, 0.25F, 0.25F};
}
[[nodiscard]] inline bool is_dark(const Record& node) {
    return node.r == 0 && node.g == 0 && node.b == 0;
}

/// Of some rows of pixels, row by row of the band's width: the corners of weight one whose primary node alone
/// shines. None lies on the border of the raster, where a corner has not the weight of four pixels.
struct PlainCorners {
    /// 1/z' of the corner at each column, 1/m; `not_plain` where it is not one of these.
    std::vector<double> inverse_depth;
    std::vector<float> r, g, b;  ///< as inverse_depth; 0 where it is not one of these
    /// All other point samples, as indices into PointSamples::samples, in their order: those of row i are
    /// [other_begin[i], other_begin[i + 1]).
    std::vector<std::uint32_t> others, other_begin;
    /// What a row's plain corners have in common.
    struct Row {
        /// Least and greatest 1/z' of what was hit, 1/m; least above greatest where nothing was.
        double least_inverse = std::numeric_limits<double>::infinity(), greatest_inverse = 0;
        bool negative = false;  ///< any colour is below zero
    };
    std::vector<Row> rows;

    static constexpr double not_plain = -1;
};

/// Of the rows that `samples` holds of `band`, without its buffers' memory being given up.
void find_plain_corners(const RecordBand& band, const PointSamples& samples, PlainCorners& out);

}  // namespace postlens
