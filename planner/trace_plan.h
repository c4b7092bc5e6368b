// How finely to trace for the lens, shutter and accuracy that are wanted: chosen before tracing.
#pragma once

#include <string>
#include <vector>

#include "tracer/scene.h"
#include "tracer/trace.h"

namespace postlens {

struct TracePlan {
    TraceSettings settings;  ///< the asked ones with subdivision, hidden layers, overscan and keys filled in
    int levels = 0;          ///< of subdivision
    double floor_db = 0;     ///< expected of the records' density, with these levels
    bool met = true;         ///< whether that leaves room for the target
    double records = 0;      ///< expected
    double bytes = 0;        ///< expected
    double seconds = 0;      ///< expected, on this machine as it is now
    std::vector<double> floors_db;  ///< by level, 0 to the greatest
    std::string text;               ///< a sentence
};

/// Looks at the scene through a trace of a quarter of the width and height: the edges found there, as high
/// and as blurred as they are, tell what each level of subdivision leaves of error (record_floor.h); the
/// coarsest is taken that leaves half of what `target_db` allows, of the picture and of nine of its tiles in
/// ten. Hidden surfaces, overscan and keys are left to the trace's own rules for the lens and the shutter;
/// without any difference in the circles of confusion of half a pixel there is nothing hidden to be seen.
/// Throws Error(wrong_arguments) where `asked` names neither for_f_number with for_focus_m nor for_shutter,
/// and what trace_to_file throws. Needs room for a file in the system's temporary folder.
[[nodiscard]] TracePlan plan_trace(const Scene& scene, const TraceSettings& asked, double target_db);

}  // namespace postlens
