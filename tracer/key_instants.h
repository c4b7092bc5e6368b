// Which instants of a shutter to record: as many as it takes to have seen what turns into view.
#pragma once

#include <vector>

#include "tracer/camera_model.h"
#include "tracer/ray_scene.h"
#include "tracer/scene.h"

namespace postlens {

/// The greatest angle, degrees, over which the camera goes round an object while the shutter is open: the sum
/// of the turns of the direction from the object's middle to the camera, in the object's own frame. So much
/// surface that could not be seen turns into view. A roll about the axis of view and a pan have none.
/// Infinite planes are left out, and what the camera is in the box of (a room), as long as it is.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// 1 up to 15 degrees: one instant suffices; beyond, 1 + ceil(sweep / 15 degrees), at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees);

/// `count` instants, 1 or more, that are spread evenly over the shutter, both ends included, without those
/// that equal `frame_s` (to 1e-9 of the times and of the shutter): growing. None for one.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
