// Computes the overscan: the margin around the frame from which light blurs or moves into the frame.
#pragma once

#include <optional>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// Returns the overscan, px, found by a coarse trace around the frame with one sample per 8 px.
/// It includes every sample whose light the lens or `motion` (may be null) brings into the frame.
/// It is at most half of the frame's longer side, and at most 4096 px.
[[nodiscard]] int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                                const std::optional<FocusGeometry>& lens, const FilmMotion* motion);

}  // namespace postlens
