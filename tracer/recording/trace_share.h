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

/// Returns the pixel rows that one program run traces if several runs share the rows y_begin to y_end - 1.
/// `share` says which of the runs it is, and how many there are. Throws Error(wrong_arguments) if there are
/// more runs than rows.
[[nodiscard]] RowRange rows_of_share(const Share& share, int y_begin, int y_end);

/// Like sample_corners, traces samples at the corners of pixels and quadtree cells, but only for a share of
/// the pixel rows. Several program runs divide the rows among them, and `share` says which of them this run
/// traces. In the other rows, each sample gets the record of a ray that hits nothing, because the file must
/// have records for all rows. The parts are merged later.
RayCounts sample_share(const Share& share, const WhittedTracer& tracer, const SampledWindow& window,
                       const SubdivisionSettings& settings,
                       const std::function<void(const RecordBand&)>& take, const SmallThings& things);

}  // namespace postlens
