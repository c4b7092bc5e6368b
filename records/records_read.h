// Callbacks for records while they are read, so that several users share one pass over the file.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Either function may be empty.
struct RecordsRead {
    /// Receives the rows [y_begin, y_end) of pixel corners in `band`. Every row is passed once, in order.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Receives the pixel rows [y_begin, y_end) of `band` and their quadtree leaves (find_leaves). Every row
    /// is passed once, from several threads.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Passes the rows [y_begin, y_end) of pixel corners in `band` to the callbacks, after finding the quadtree
/// leaves. The band must hold one more row below, if the file has one; else the last row has no pixels.
/// Throws the errors of find_leaves and of the callbacks.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
