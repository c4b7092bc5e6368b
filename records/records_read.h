// Callbacks for records while they are read, so that several users share one pass over the file.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Either function may be empty.
struct RecordsRead {
    /// Receives the corner rows [y_begin, y_end) of `band`; every row once, in order.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Receives the pixel rows [y_begin, y_end) of `band` and their leaves (find_leaves); every row once,
    /// from several threads.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Passes the corner rows [y_begin, y_end) of a band to the callbacks, after finding their leaves. The band
/// must hold one more row below, if the file has one; else the last row has no pixels. Throws what
/// find_leaves and the callbacks throw.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
