// Camera parameters of another program's image: given by the user, read from the file, or assumed.
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

/// Settings from the user for the camera of another program's image. An absent value is read from the image
/// file's attributes or assumed.
struct ForeignCameraChoice {
    std::optional<double> film_width_mm, film_distance_mm, focal_length_mm, metres_per_unit;
    std::optional<DepthAlong> depth_along;
    /// Width of the rendered margin around the image, in pixels of the display window on every side.
    /// `film_width_mm` excludes this margin.
    int overscan_px = 0;
};

struct ForeignCamera {
    double film_width_mm = 36;     ///< of the display window
    double film_distance_mm = 50;  ///< from the pinhole; with the width, it gives the field of view
    double focal_length_mm = 50;   ///< of the lens that focuses the image
    double metres_per_unit = 1;    ///< metres per unit of Z
    DepthAlong depth_along = DepthAlong::axis;
    /// Offset of the image's centre from the optical axis, to the right and down, divided by the film
    /// distance. Nonzero for a shifted lens.
    double centre_x = 0, centre_y = 0;
    /// True if the film distance is not stated by the file or the user. It is then assumed to be the focal
    /// length.
    bool film_distance_from_focal_length = false;
    std::optional<double> f_number, focus_m;
    /// Messages about values that are assumed because they are not stated by the file or the user.
    std::vector<std::string> assumed;
};

/// Determines the camera from the file and the user's settings `choice`. docs/inputs.md lists the sources of
/// each value. Ignores attributes of the file whose value is not positive and finite. Throws
/// Error(wrong_arguments) for such a value in `choice`.
[[nodiscard]] ForeignCamera foreign_camera(const ForeignFile& file, std::size_t part,
                                           const ForeignCameraChoice& choice);

/// Returns the tangent of half the horizontal angle of view, from two matrices in the OpenEXR header. The
/// normalised device coordinates of worldToNDC may run from 0 to 1, as OpenEXR specifies, or from -1 to 1.
/// Returns empty unless the matrices describe a perspective projection.
[[nodiscard]] std::optional<double> half_width_tangent(const Matrix44& world_to_camera,
                                                       const Matrix44& world_to_ndc);

}  // namespace postlens
