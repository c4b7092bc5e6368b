// Chooses the settings of a trace for a given lens, shutter and target error.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "tracer/trace.h"

namespace postlens {

struct TracePlan {
    TraceSettings settings;  ///< given settings, with subdivision, hidden layers, overscan and keys chosen
    int levels = 0;          ///< chosen levels of subdivision
    double floor_db = 0;     ///< record floor that is expected with these levels, as PSNR
    bool met =
        true;  ///< false if the record floor exceeds the target at every level; always true with `for_rays`
    double records = 0;             ///< expected number of records
    double bytes = 0;               ///< expected size of the file
    double seconds = 0;             ///< expected time of the trace, on this machine at its present load
    std::vector<double> floors_db;  ///< record floor per level, from 0 on
    std::string text;               ///< the plan in one sentence, for the log
};

/// Chooses the settings of a trace, from a preview with a quarter of the width and height.
///
/// The record floor is the error due to the size of quadtree cells. The coarsest level of subdivision is
/// chosen whose record floor is at most half of the squared error that `target_db` allows. This must hold for
/// the mean of the image and for nine of ten tiles. With `for_rays`, the level is always
/// TraceSettings::ray_levels.
///
/// Hidden surfaces are not recorded if all circles of confusion differ by less than half a pixel.
///
/// Throws Error(wrong_arguments) if `asked` has neither for_shutter nor both for_f_number and for_focus_m.
/// Also throws the errors of trace_to_file. Writes a file to the system's temporary folder.
[[nodiscard]] TracePlan plan_trace(const Scene& scene, const TraceSettings& asked, double target_db,
                                   bool for_rays = false);

}  // namespace postlens
