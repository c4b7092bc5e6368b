#include "tracer/recording/trace_share.h"

#include <algorithm>

#include "core/error.h"
#include "records/lost_rows.h"

namespace postlens {

RowRange rows_of_share(const Share& share, int y_begin, int y_end) {
    const int rows = y_end - y_begin;
    if (share.count > rows) {
        fail(ExitCode::wrong_arguments, "--share: more shares than rows (got {}; expected {} or less)",
             share.count, rows);
    }
    const auto row = [&](int i) {
        return y_begin + static_cast<int>(static_cast<std::int64_t>(rows) * i / share.count);
    };
    return {row(share.index), row(share.index + 1)};
}

RayCounts sample_share(const Share& share, const WhittedTracer& tracer, const SampledWindow& window,
                       const SubdivisionSettings& settings,
                       const std::function<void(const RecordBand&)>& take, const SmallThings& things) {
    const RowRange rows = rows_of_share(share, window.y_begin, window.y_end + 1);
    const int x_end = window.x_end + 1;
    RecordBand absent, last;
    for (int y = window.y_begin; y < rows.begin; ++y) {
        absent = stand_in_row(nullptr, window.x_begin, x_end, y);
        take(absent);
    }
    // Traces the pixel rows that this program run must trace, and also the row above them. If pixels of that
    // row are subdivided, they have samples on their lower edge, which belong to the first row of this run.
    const SampledWindow traced{window.x_begin, window.x_end, std::max(window.y_begin, rows.begin - 1),
                               std::min(window.y_end, rows.end)};
    const RayCounts rays = sample_corners(
        tracer, traced, settings,
        [&](const RecordBand& band) {
            last = rows_of(band, std::max(band.y_begin, rows.begin), std::min(band.y_end, rows.end));
            if (last.height() > 0) take(last);
        },
        things);
    for (int y = rows.end; y <= window.y_end; ++y) {
        absent = stand_in_row(y == rows.end ? &last : &absent, window.x_begin, x_end, y);
        take(absent);
    }
    return rays;
}

}  // namespace postlens
