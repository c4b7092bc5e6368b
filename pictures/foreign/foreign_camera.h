// The camera of another program's image. Its values come from attributes of the file, from options, or are
// assumed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

enum class DepthAlong {
    axis,  ///< Z is the distance along the optical axis
    ray,   ///< Z is the distance from the camera's centre
};

/// Settings from the user. Absent values are read from the file's attributes or assumed.
struct ForeignCameraChoice {
    std::optional<double> film_width_mm, film_distance_mm, focal_length_mm, metres_per_unit;
    std::optional<DepthAlong> depth_along;
    /// Number of pixels by which the display window extends beyond the frame on every side. Programs render
    /// beyond the frame by using a larger film; `film_width_mm` is then the film width of the frame alone.
    int overscan_px = 0;
};

struct ForeignCamera {
    double film_width_mm = 36;     ///< of the display window
    double film_distance_mm = 50;  ///< from the pinhole; determines, with the width, the field of view
    double focal_length_mm = 50;   ///< of the lens that focuses the image
    double metres_per_unit = 1;    ///< metres per unit of Z
    DepthAlong depth_along = DepthAlong::axis;
    /// True if neither the file nor the user states the film distance. It then equals the focal length that
    /// the user states, or the default.
    bool film_distance_from_focal_length = false;
    std::optional<double> f_number, focus_m;
    /// One text for each value that is assumed, because neither the file nor the user states it.
    std::vector<std::string> assumed;
};

/// Determines the camera. docs/inputs.md lists the sources of each value, in order of priority. Throws
/// Error(wrong_arguments) for choices that are not positive and finite; attributes with such values are
/// ignored.
[[nodiscard]] ForeignCamera foreign_camera(const ForeignFile& file, std::size_t part,
                                           const ForeignCameraChoice& choice);

/// Tangent of half the horizontal angle of view, computed from OpenEXR's worldToCamera and worldToNDC. Absent
/// if these matrices are not a perspective projection. NDC (normalised device coordinates) may run across the
/// image from 0 to 1, as in OpenEXR, or from -1 to 1.
[[nodiscard]] std::optional<double> half_width_tangent(const Matrix44& world_to_camera,
                                                       const Matrix44& world_to_ndc);

}  // namespace postlens
