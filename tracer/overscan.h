// How far around the frame records are needed: as far as something there blurs or moves back into it.
#pragma once

#include <optional>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/film_motion.h"
#include "tracer/whitted.h"

namespace postlens {

/// In px, from a coarse trace around the frame: as far as the circle of confusion of `lens` reaches back into
/// the frame, or what is seen there, hidden surfaces of `tracer` included, comes to the frame at an instant
/// of `motion`; the wider of both, to the samples' distance of 8 px upwards. At most half of the frame's
/// longer side, and 4096. `motion` may be null.
[[nodiscard]] int find_overscan(const WhittedTracer& tracer, const CameraModel& camera,
                                const std::optional<FocusGeometry>& lens, const FilmMotion* motion);

}  // namespace postlens
