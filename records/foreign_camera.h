// What camera another program's picture was taken with: from its attributes, from options, else assumed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "records/foreign_file.h"

namespace postlens {

enum class DepthAlong {
    axis,  ///< Z is the distance along the optical axis
    ray,   ///< Z is the distance from the camera's centre
};

/// What the user says; absent: by the file's attributes, else assumed.
struct ForeignCameraChoice {
    std::optional<double> film_width_mm, film_distance_mm, focal_length_mm, metres_per_unit;
    std::optional<DepthAlong> depth_along;
    /// The display window is so many pixels wider than the frame on every side, as where a program renders
    /// beyond the frame by a larger film. `film_width_mm` is then the frame's.
    int overscan_px = 0;
};

struct ForeignCamera {
    double film_width_mm = 36;     ///< of the display window
    double film_distance_mm = 50;  ///< from the pinhole; with the width: the view
    double focal_length_mm = 50;   ///< of the lens that the picture is to be focused by
    double metres_per_unit = 1;    ///< of Z
    DepthAlong depth_along = DepthAlong::axis;
    std::optional<double> f_number, focus_m;
    /// One text for each value that neither the file nor the user has named.
    std::vector<std::string> assumed;
};

/// docs/inputs.md lists where each value comes from, in order. Throws Error(wrong_arguments) for choices that
/// are not positive and finite; attributes that are not are left aside.
[[nodiscard]] ForeignCamera foreign_camera(const ForeignFile& file, std::size_t part,
                                           const ForeignCameraChoice& choice);

/// Half the width of the view over its distance, from OpenEXR's worldToCamera and worldToNDC; absent where
/// they are no perspective. NDC may reach from 0 to 1 across the picture, as OpenEXR has it, or from -1 to 1.
[[nodiscard]] std::optional<double> half_width_tangent(const Matrix44& world_to_camera,
                                                       const Matrix44& world_to_ndc);

}  // namespace postlens
