// Computes the overscan: pixels around the frame that are traced because their light blurs or moves into it.
#pragma once

#include <optional>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// Returns the overscan, i.e. the width, px, of the border around the frame that must be traced, too. The
/// border contains all surface points whose light the blur of `lens` or the movement `motion` (may be null)
/// brings into the frame. The width is found by a coarse trace with one sample per 8 px. It is at most half
/// of the frame's longer side and at most 4096 px.
[[nodiscard]] int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                                const std::optional<FocusGeometry>& lens, const FilmMotion* motion);

}  // namespace postlens
