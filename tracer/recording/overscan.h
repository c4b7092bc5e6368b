// Finds the overscan: the distance around the frame from which light blurs or moves into the frame.
#pragma once

#include <optional>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/shading_trees/film_motion.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

/// The overscan, px, from a coarse trace around the frame with one sample per 8 px. It includes every sample
/// whose circle of confusion by `lens` reaches the frame, and every sample with a surface, visible or hidden,
/// that moves into the frame at an instant of `motion`. It is at most half of the frame's longer side and
/// 4096 px. `motion` may be null.
[[nodiscard]] int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                                const std::optional<FocusGeometry>& lens, const FilmMotion* motion);

}  // namespace postlens
