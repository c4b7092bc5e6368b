// Who else is told of records that are read, so that they are read and taken apart once.
#pragma once

#include <functional>

#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Either may be none.
struct RecordsRead {
    /// Corner rows [y_begin, y_end) of `band`: each row once and in order.
    std::function<void(const RecordBand& band, int y_begin, int y_end)> rows;
    /// Rows [y_begin, y_end) of pixels of `band` with their leaves, as find_leaves has them: each row once,
    /// from several threads.
    std::function<void(const RecordBand& band, int y_begin, int y_end, const PixelLeaves& leaves)> leaves;
};

/// Tells of corner rows [y_begin, y_end) of a band that nobody has taken apart. The band must have one row
/// more below them where the file has one; without it the last row is none of pixels. Throws what find_leaves
/// and those who are told throw.
void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end);

}  // namespace postlens
