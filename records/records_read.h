// Callbacks that receive records while a file is read, so that one pass serves several purposes.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Functions that receive the records. A function that is empty is not called.
struct RecordsRead {
    /// Receives the point samples of rows y_begin to y_end - 1. Each row is passed once, from top to bottom.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Receives the pixel rows y_begin to y_end - 1 of `band`, and in `leaves` the leaves (undivided cells)
    /// of the quadtrees into which their pixels are divided. Each row is passed once. The function may be
    /// called by several threads at once.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Passes the rows y_begin to y_end - 1 of `band` to the functions in `to`: calls `to.rows` for the rows, and
/// `to.leaves` for the quadtree leaves (undivided cells) of their pixels. The lower corners of the leaves in
/// a row are stored in the next row, so row y_end must be in `band` too. The last row of the file has no next
/// row, and therefore no leaves. Throws the errors of find_leaves, `to.rows` and `to.leaves`.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
