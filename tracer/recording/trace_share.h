// Traces only some rows of a frame (a share), so that several runs can divide the work.
#pragma once

#include <functional>

#include "core/share.h"
#include "records/record.h"
#include "tracer/recording/corner_sampler.h"

namespace postlens {

/// Rows [begin, end) of records.
struct RowRange {
    int begin = 0, end = 0;
};

/// Returns which of the rows [y_begin, y_end) one of several runs traces. The numbers of rows of two runs are
/// equal or differ by one.
/// Throws Error(wrong_arguments) if there are more runs than rows.
[[nodiscard]] RowRange rows_of_share(const Share& share, int y_begin, int y_end);

/// Like sample_corners, but traces only those rows of `window` that belong to one of several runs.
/// The other rows are passed to `take`, too, so that the file is complete. They contain records of rays that
/// hit nothing (records/lost_rows.h).
RayCounts sample_share(const Share& share, const WhittedTracer& tracer, const SampledWindow& window,
                       const SubdivisionSettings& settings,
                       const std::function<void(const RecordBand&)>& take, const SmallThings& things);

}  // namespace postlens
