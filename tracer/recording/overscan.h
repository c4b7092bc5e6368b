// Computes the overscan: pixels around the frame that are traced because their light blurs or moves into it.
#pragma once

#include <optional>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// Returns the overscan, i.e. how many pixels around the frame must be traced. It contains all samples whose
/// light the lens or `motion` (may be null) brings into the frame.
/// It is found by a coarse trace with one sample per 8 px, and is at most half of the frame's longer side and
/// 4096.
[[nodiscard]] int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                                const std::optional<FocusGeometry>& lens, const FilmMotion* motion);

}  // namespace postlens
