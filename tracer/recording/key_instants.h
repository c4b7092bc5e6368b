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
/// object. The angle measures how much of the object's hidden surface turns into view. It is 0 for a roll
/// about the optical axis and for a pan. Infinite planes are ignored, and so is an object (such as a room)
/// while the camera is inside its bounding box.
[[nodiscard]] double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter);

/// Returns the greatest angle, degrees, by which the direction of light on a visible surface turns while the
/// shutter is open. It is the total rotation of the direction from a point of the surface to a light, in the
/// frame of the surface's object, if the light or the object moves. The points are those that a coarse grid
/// of rays sees at `recorded_s`; surfaces that do not respond to lights are ignored.
[[nodiscard]] double light_sweep_degrees(const Scene& scene, const CameraModel& camera, double recorded_s,
                                         const TimeSpan& shutter);

/// Returns the angle, degrees, by which the optical axis of a perspective camera turns while the shutter is
/// open.
[[nodiscard]] double pan_degrees(const Camera& camera, const TimeSpan& shutter);

/// Returns the angle, degrees, from the optical axis to the nearer of the frame's edges. If a camera pans and
/// there is a key (recorded instant) for every such angle, the keys record everything that the frame shows
/// between them.
[[nodiscard]] double half_field_degrees(const CameraModel& camera);

/// A number of keys, and the motion that it is for.
struct KeyCount {
    int keys = 1;
    double sweep_degrees = 0;
    const char* what = "";  ///< what turns by `sweep_degrees`
};

/// Returns the number of keys (recorded instants) that a scene needs: for the turns of objects and of light,
/// one for every `degrees_per_key`, and those for the camera's pan.
[[nodiscard]] KeyCount automatic_keys(const Scene& scene, const Camera& camera,
                                      const CameraOverrides& overrides, double recorded_s,
                                      const TimeSpan& shutter, double degrees_per_key);

/// Returns the number of keys (recorded instants) for a sweep: 1 up to `degrees_per_key`, else 1 + ceil(sweep
/// / degrees_per_key), at most 64.
[[nodiscard]] int keys_for_sweep(double sweep_degrees, double degrees_per_key);

/// Returns `count` instants, evenly spaced over the shutter interval including both ends, in ascending order.
/// Instants that equal `frame_s` up to a relative rounding of 1e-9 are omitted. Empty if `count` is 1.
[[nodiscard]] std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s);

}  // namespace postlens
