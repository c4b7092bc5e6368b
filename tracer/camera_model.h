// The pinhole (or orthographic) camera at one instant: raster positions to rays.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "tracer/scene.h"

namespace postlens {

/// What the command line may set over the scene's camera.
struct CameraOverrides {
    std::optional<int> width, height;
    std::optional<double> film_distance_mm;  ///< from pinhole to film: the view
    std::optional<double> film_width_mm;
};

/// A ray of the camera. Tangents are in raster axes (x right, y down): direction = (tan_x, -tan_y, -1) in the
/// camera frame, before it is made unit length.
struct CameraRay {
    glm::dvec3 origin{0}, direction{0, 0, -1};  ///< world, unit length
    double cos_axis = 1;                        ///< cosine between direction and optical axis
};

class CameraModel {
  public:
    /// Throws Error(wrong_arguments) for overrides out of range, Error(invalid_input) for a camera without a
    /// view.
    CameraModel(const Camera& camera, double time_s, const CameraOverrides& overrides = {});

    /// x, y in raster px; any real number, also outside the raster.
    [[nodiscard]] CameraRay ray(double x, double y) const;
    /// The raster position of a point of the world, px; nothing where it is not in front of the pinhole.
    [[nodiscard]] std::optional<glm::dvec2> place(const glm::dvec3& point) const;
    /// The same of what lies infinitely far away in a direction; perspective only.
    [[nodiscard]] std::optional<glm::dvec2> place_at_infinity(const glm::dvec3& direction) const;

    int width = 0, height = 0;
    Camera::Projection projection = Camera::Projection::perspective;
    double film_distance_mm = 0;  ///< d; perspective
    double pixel_pitch_mm = 0;    ///< on the film; orthographic: in the scene
    double tangent_per_px = 0;    ///< pitch / d; perspective
    glm::dmat4 world_from_camera{1};
    glm::dmat4 rest_from_camera{1};  ///< the same before the camera's own motion

    /// World directions of the raster axes: x right, y down; and of the optical axis. Unit length.
    glm::dvec3 right{1, 0, 0}, down{0, -1, 0}, forward{0, 0, -1}, position{0};
};

}  // namespace postlens
