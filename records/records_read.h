// Callbacks that receive records while a file is read, so that several users share one pass over the file.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Either function may be empty.
struct RecordsRead {
    /// Receives the rows [y_begin, y_end) of pixel corners in `band`. Each row is passed once, from top to
    /// bottom.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Receives the pixel rows [y_begin, y_end) of `band` with their quadtree leaves (see find_leaves). Each
    /// row is passed once. Several threads call this function.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Passes the rows [y_begin, y_end) of pixel corners in `band` to the callbacks, and computes the quadtree
/// leaves for them. If the file has row y_end, `band` must contain it; if not, row y_end - 1 contains only
/// corners and no pixels. Throws the errors of find_leaves and of the callbacks.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
