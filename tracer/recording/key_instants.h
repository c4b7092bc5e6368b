// Chooses the instants of a shutter interval at which a scene is recorded. There are enough instants to
// record the surfaces that become visible when objects turn.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// The greatest angle, degrees, by which the camera moves around an object while the shutter is open: the
/// total rotation of the direction from the object's centre to the camera, in the object's own frame. This
/// measures how much hidden surface turns into view. It is 0 for a roll about the optical axis and for a pan.
/// Infinite planes do not count, nor does an object (a room) while the camera is inside its bounding box.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// Number of keys for a sweep: 1 up to 15 degrees, else 1 + ceil(sweep / 15 degrees), at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees);

/// `count` instants, evenly spaced over the shutter with both ends included, in ascending order. Instants
/// that equal `frame_s`, to 1e-9 of the times and of the shutter, are left out. Empty if `count` is 1.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
