#include "records/records_read.h"

#include <algorithm>

#include "core/threads.h"

namespace postlens {

void tell(const RecordsRead& to, const RecordBand& band, int y_begin, int y_end) {
    if (to.rows) to.rows(band, y_begin, y_end);
    const int end = std::min(y_end, band.y_end - 1);
    if (!to.leaves || y_begin >= end) return;
    constexpr int rows_per_task = 8;
    parallel_for(static_cast<std::size_t>((end - y_begin + rows_per_task - 1) / rows_per_task),
                 [&](std::size_t task) {
                     const int first = y_begin + static_cast<int>(task) * rows_per_task,
                               last = std::min(first + rows_per_task, end);
                     PixelLeaves leaves;
                     find_leaves(band, first, last, leaves);
                     to.leaves(band, first, last, leaves);
                 });
}

}  // namespace postlens
