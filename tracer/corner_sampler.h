// Pixel-corner sampling with recursive 2x2 subdivision. Every point sample is traced once, although cells
// share corners.
#pragma once

#include <cstdint>
#include <functional>

#include "records/record.h"
#include "tracer/small_things.h"
#include "tracer/whitted.h"

namespace postlens {

struct SubdivisionSettings {
    int levels = 0;  ///< greatest depth of the subdivision, 0 to 8
    /// Greatest depth to which edges alone subdivide, at most `levels`; deeper levels are for small objects
    /// (SmallThings).
    int edge_levels = 8;
    double threshold =
        0.1;  ///< contrast (max - min) / (max + min + 0.05), any channel, above which a cell splits
    int colour_levels = 8;  ///< greatest depth to which contrast alone splits; edges go down to `edge_levels`
};

/// The pixels [x_begin, x_end) x [y_begin, y_end) to sample. Their records also cover the corners at column
/// x_end and row y_end.
struct SampledWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Traces the window in bands of rows and passes each complete band to `take`, from top to bottom. Subdivides
/// a cell
/// - if the primary ids of its corners differ, down to `edge_levels`;
/// - if their colours, or those of the texture between them, differ by a contrast above `threshold`, down to
///   `colour_levels`;
/// - if different lights are shadowed at its corners;
/// - if `things` requires it, down to `levels`.
/// The first three also apply to every hidden layer. Needs memory for one band only. Deterministic for any
/// number of threads. Returns the number of rays.
RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things = {});

}  // namespace postlens
