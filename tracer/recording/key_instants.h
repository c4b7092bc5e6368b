// Chooses the instants of a shutter interval at which a scene is recorded. They must be close enough to
// record surfaces that become visible when objects turn.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Returns the greatest angle, degrees, by which the camera moves around an object while the shutter is open.
/// It is the total rotation of the direction from the object's centre to the camera, in the frame of the
/// object. It measures how much of the hidden surface turns into view. It is 0 for a roll about the optical
/// axis and for a pan. Infinite planes are ignored, and so is an object (such as a room) while the camera is
/// inside its bounding box.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// Returns the number of keys (recorded instants) for a sweep: 1 up to `degrees_per_key`, else 1 + ceil(sweep
/// / degrees_per_key), at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees, double degrees_per_key);

/// Returns `count` instants, evenly spaced over the shutter interval including both ends, in ascending order.
/// Instants that equal `frame_s` up to a relative rounding of 1e-9 are omitted. Empty if `count` is 1.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
