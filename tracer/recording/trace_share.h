// Traces a share of a frame (some of its rows), so that several runs can divide the work.
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

/// Returns the rows of one share of a frame's rows [y_begin, y_end). Shares differ by at most one row.
/// Throws Error(wrong_arguments) if there are more shares than rows.
[[nodiscard]] RowRange rows_of_share(const Share& share, int y_begin, int y_end);

/// Traces the rows of `window` that belong to the share, like sample_corners.
/// For every other row, `take` receives records of rays that hit nothing (records/lost_rows.h).
RayCounts sample_share(const Share& share, const WhittedTracer& tracer, const SampledWindow& window,
                       const SubdivisionSettings& settings,
                       const std::function<void(const RecordBand&)>& take, const SmallThings& things);

}  // namespace postlens
