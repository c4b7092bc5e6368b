// Pixel-corner sampling with recursive 2x2 subdivision: which point samples to take, each taken once.
#pragma once

#include <cstdint>
#include <functional>

#include "records/record.h"
#include "tracer/small_things.h"
#include "tracer/whitted.h"

namespace postlens {

struct SubdivisionSettings {
    int levels = 0;  ///< greatest depth of the subdivision, 0 to 8
    /// Greatest depth to which edges alone split, at most `levels`; what lies deeper is for small things.
    int edge_levels = 8;
    double threshold =
        0.1;  ///< contrast (max - min) / (max + min + 0.05), any channel, above which a cell splits
    int colour_levels = 8;  ///< greatest depth to which contrast alone splits; edges go down to `edge_levels`
};

/// Pixels [x_begin, x_end) x [y_begin, y_end) are sampled; records also fill the closing column and row of
/// corners.
struct SampledWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Traces the window band by band and hands each band, complete and in order, to `take`. A cell splits where
/// the primary ids of its corners differ (down to `edge_levels`) or their colours do (contrast above
/// `threshold`, down to `colour_levels`, of the texture between them, too), or the lights that are kept from
/// them, of what is seen and of each hidden layer, and where `things` asks for it (down to `levels`). Memory
/// stays bounded by a band. Deterministic for any number of threads. Returns the rays spent.
RayCounts sample_corners(const WhittedTracer& tracer, const SampledWindow& window,
                         const SubdivisionSettings& settings,
                         const std::function<void(const RecordBand&)>& take, const SmallThings& things = {});

}  // namespace postlens
