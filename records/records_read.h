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

/// Passes rows y_begin to y_end - 1 to the functions of `to`, with the leaves (undivided cells) of their
/// quadtrees. `band` must also contain row y_end, because the lower corners of these cells lie there. The
/// last row of the file has no leaves, because no row follows. Throws the errors of find_leaves and of these
/// functions.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
