// Chooses the instants of the shutter interval at which a moving scene is traced and recorded.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Returns how far objects turn relative to the camera during the shutter interval. For each object, the
/// total angle, in degrees, is computed, and the greatest angle is returned. An object's angle is the turn of
/// the direction from its centre to the camera, as seen from the object. So it is 0 if the camera only pans
/// or rolls. Ignores infinite planes, and objects whose bounding box contains the camera.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// Returns the total angle, degrees, by which the camera's optical axis turns. 0 if it is orthographic.
[[nodiscard]] double pan_degrees(const Camera& camera, const TimeSpan& shutter);

/// Returns the angle, degrees, between the optical axis and the nearest edge of the frame. The camera may pan
/// by at most this angle from one recorded instant to the next, so that the frames of these instants overlap.
[[nodiscard]] double half_field_degrees(const CameraModel& camera);

struct KeyRules {
    double degrees_per_key = 15;  ///< turn of an object relative to the camera
    double light_db = 43;         ///< target PSNR of changing light (light_keys)
    DistributedSettings tracing;  ///< settings of the rays that measure this light
};

/// A number of keys, and what determines it.
struct KeyCount {
    int keys = 1;
    double sweep_degrees = 0;  ///< view_sweep_degrees, or pan_degrees if that needs more keys
    std::string reason;        ///< such as "something turns by 60 degrees"
};

/// Returns how many instants must be recorded, evenly spaced over the shutter interval, so that each object
/// that comes into view is recorded at least once while it is in view. The result lies between `at_least` and
/// 64. Time spans that are so short that even 64 instants miss them are ignored.
/// - `recorded_s`: the frame's own instant, s; it is recorded in any case, so time spans that contain it need
///   no other
[[nodiscard]] int keys_for_visits(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                                  double recorded_s, const TimeSpan& shutter, int at_least);

/// Returns the number of keys (recorded instants) that the scene needs for its shutter interval. Several keys
/// are needed if:
/// - an object turns: one key for each angle `degrees_per_key`
/// - the camera pans
/// - an object is in view, or is large, or encloses the camera, during only a part of the interval
/// - the light on surfaces changes
[[nodiscard]] KeyCount automatic_keys(const Scene& scene, const Camera& camera,
                                      const CameraOverrides& overrides, double recorded_s,
                                      const TimeSpan& shutter, const KeyRules& rules);

/// Returns the number of keys, i.e. instants to be recorded, that an object needs if it turns by
/// `sweep_degrees` relative to the camera. The number is 1 if the object turns by at most `degrees_per_key`.
/// Otherwise, it is 1 + ceil(sweep_degrees / degrees_per_key), but at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees, double degrees_per_key);

/// Returns `count` evenly spaced instants of the shutter interval, ascending, including both ends.
/// Omits the frame's own instant, `frame_s`, which is always recorded. Empty if `count` is 1.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
