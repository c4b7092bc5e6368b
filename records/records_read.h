// Functions that receive the records (surface hits) of a sample file while it is read. Several of them can
// use the same reading, for example to make an image and to estimate its error.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Functions that receive the records. A function that is empty is not called.
struct RecordsRead {
    /// Receives the point samples of rows y_begin to y_end - 1. Each row is passed once, from top to bottom.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Receives the pixel rows y_begin to y_end - 1 of `band`, each row once. These pixels are divided into
    /// quadtrees, and `leaves` contains the undivided cells of the quadtrees. Several threads may call the
    /// function at once.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Passes the rows y_begin to y_end - 1 of a file to `to.rows` as records, and to `to.leaves` as quadtree
/// leaves (undivided cells). `band` must also contain row y_end, which has the lower corners of the last
/// leaves, unless the file ends there. The last row of a file has no leaves. Throws the errors of
/// find_leaves, `to.rows` and `to.leaves`.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
