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

/// Returns the rows that one of several program runs traces. Throws Error(wrong_arguments) if there
/// are more runs than rows.
[[nodiscard]] RowRange rows_of_share(const Share& share, int y_begin, int y_end);

/// Traces the samples at the corners of pixels and quadtree cells, like sample_corners, but for one of
/// several program runs that share the work. Traces only the pixel rows of this run, which `share`
/// determines. All other rows get records of rays that hit nothing, in place of those that other runs trace.
RayCounts sample_share(const Share& share, const WhittedTracer& tracer, const SampledWindow& window,
                       const SubdivisionSettings& settings,
                       const std::function<void(const RecordBand&)>& take, const SmallThings& things);

}  // namespace postlens
