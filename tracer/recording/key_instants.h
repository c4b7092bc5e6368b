// Chooses the instants of a shutter interval at which a scene is recorded. They must be close enough to
// record surfaces that become visible when objects turn.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Returns the greatest angle, degrees, by which the camera moves around an object while the shutter is open.
/// It is the total rotation of the direction from the object's centre to the camera, in the frame of the
/// object. The angle measures how much of the object's hidden surface turns into view. It is 0 for a roll
/// about the optical axis and for a pan. Infinite planes are ignored, and so is an object (such as a room)
/// while the camera is inside its bounding box.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// Returns the angle, degrees, by which the optical axis of a perspective camera turns while the shutter is
/// open.
[[nodiscard]] double pan_degrees(const Camera& camera, const TimeSpan& shutter);

/// Returns the angle, degrees, from the optical axis to the nearer of the frame's edges. If a camera pans and
/// there is a key (recorded instant) for every such angle, the keys record everything that the frame shows
/// between them.
[[nodiscard]] double half_field_degrees(const CameraModel& camera);

struct KeyRules {
    double degrees_per_key = 15;  ///< that an object turns relative to the camera
    double light_db = 43;         ///< PSNR of the light that changes (light_keys)
    DistributedSettings tracing;  ///< of the rays that measure this light
};

/// A number of keys, and what determines it.
struct KeyCount {
    int keys = 1;
    double sweep_degrees = 0;  ///< view_sweep_degrees, or pan_degrees if that needs more keys
    std::string reason;        ///< such as "something turns by 60 degrees"
};

/// Returns the smallest number of evenly spaced keys, `at_least` or more, with which a key lies within every
/// span of time in which the camera's frame shows a moving object at half of its largest size in the frame or
/// more, or 64. `recorded_s` is recorded as well. An object is its bounding sphere, which nothing hides.
[[nodiscard]] int keys_for_visits(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                                  double recorded_s, const TimeSpan& shutter, int at_least);

/// Returns the number of keys for the turns of objects, one for every `degrees_per_key`, for the camera's
/// pan, for objects that are in view or large for a short time, and for the light that changes.
[[nodiscard]] KeyCount automatic_keys(const Scene& scene, const Camera& camera,
                                      const CameraOverrides& overrides, double recorded_s,
                                      const TimeSpan& shutter, const KeyRules& rules);

/// Returns the number of keys (recorded instants) for a sweep: 1 up to `degrees_per_key`, else 1 + ceil(sweep
/// / degrees_per_key), at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees, double degrees_per_key);

/// Returns `count` instants, evenly spaced over the shutter interval including both ends, in ascending order.
/// Instants that equal `frame_s` up to a relative rounding of 1e-9 are omitted. Empty if `count` is 1.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
