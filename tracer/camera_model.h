// The pinhole (or orthographic) camera at one instant. It maps raster positions to rays.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "scene/scene.h"

namespace postlens {

/// Command-line settings that replace those of the scene's camera.
struct CameraOverrides {
    std::optional<int> width, height;
    std::optional<double> film_distance_mm;  ///< from pinhole to film
    std::optional<double> film_width_mm;
};

/// An eye ray: from the pinhole through a raster position, or parallel to the axis of an orthographic camera.
struct CameraRay {
    glm::dvec3 origin{0}, direction{0, 0, -1};  ///< world, unit length
    double cos_axis = 1;                        ///< cosine of the angle between the ray and the optical axis
};

class CameraModel {
  public:
    /// Throws Error(wrong_arguments) if an override is out of range.
    /// Throws Error(invalid_input) if position, look_at and up of the camera define no orientation.
    CameraModel(const Camera& camera, double time_s, const CameraOverrides& overrides = {});

    /// Returns the ray through a raster position, px, which may lie outside the image.
    [[nodiscard]] CameraRay ray(double x, double y) const;
    /// Projects a world point to a raster position, px. Empty if the point is not in front of the pinhole.
    [[nodiscard]] std::optional<glm::dvec2> place(const glm::dvec3& point) const;
    /// Projects a point at infinity, given by its world direction, to a raster position, px.
    /// Empty if the direction does not point forwards. Only for perspective cameras.
    [[nodiscard]] std::optional<glm::dvec2> place_at_infinity(const glm::dvec3& direction) const;

    int width = 0, height = 0;
    Camera::Projection projection = Camera::Projection::perspective;
    double film_distance_mm = 0;  ///< perspective only
    double pixel_pitch_mm = 0;    ///< on the film, or in the scene if orthographic
    double tangent_per_px = 0;    ///< pixel pitch / film distance; perspective only
    glm::dmat4 world_from_camera{1};
    glm::dmat4 rest_from_camera{1};  ///< world_from_camera without the camera's motion

    /// Pose of the camera in the world. `position` is the pinhole, m.
    /// `right` and `down` are unit vectors along the raster axes, `forward` along the optical axis.
    glm::dvec3 right{1, 0, 0}, down{0, -1, 0}, forward{0, 0, -1}, position{0};
};

}  // namespace postlens
