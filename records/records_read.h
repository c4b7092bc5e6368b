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
    /// Receives pixel rows y_begin to y_end - 1 and the leaves (undivided cells) of their quadtrees. Each row
    /// is passed once. May be called by several threads at once.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Reports rows y_begin to y_end - 1 of `band` to `to`: calls `to.rows` for them, and `to.leaves` for their
/// quadtree leaves (undivided cells). Row y_end must be in `band` too, because it contains the lower corners
/// of the leaves. The last row of the file has no row below it, and therefore no leaves. Throws the errors of
/// find_leaves, `to.rows` and `to.leaves`.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
