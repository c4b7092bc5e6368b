// Converts a shift of the viewpoint on the lens, in m, to the shift of a scene point's image, in px. The
// factor between the two shifts depends on the depth of the point and on the focus distance.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "lens/thin_lens.h"

namespace postlens {

enum class Framing {
    keep,       ///< F changes only the aperture, not the field of view
    lens,       ///< film distance F: the image is cropped or magnified
    breathing,  ///< film distance V = F s / (s - F) [potmesil1981]
};

/// The film of the camera with which a file was traced.
struct Film {
    double distance_mm = 0;     ///< distance d from the lens; > 0
    double pixel_pitch_mm = 0;  ///< > 0
};

/// Throws Error(wrong_arguments) unless both lengths are positive and finite.
void check_film(const Film& film);

/// A lens that is focused at the distance s. Seen from the lens point q, in m from the lens centre in raster
/// axes, the image of a point at depth z' is shifted from its pinhole image by
///
///     gain_px * (1/s - 1/z') * q    px
struct FocusGeometry {
    double aperture_radius_m = 0;    ///< F / (2 n); 0 is a pinhole
    double inverse_focus_per_m = 0;  ///< 1/s; 0 when focused at infinity
    double gain_px = 0;              ///< film distance d / pixel pitch, after framing, px
    double zoom = 1;                 ///< magnification of the raster about its centre

    /// Returns the signed diameter of the circle of confusion, in px. It is positive behind the focus
    /// distance, and finite for every inverse depth.
    [[nodiscard]] double coc_diameter_px(double inverse_depth_per_m) const {
        return 2 * aperture_radius_m * gain_px * (inverse_focus_per_m - inverse_depth_per_m);
    }
};

/// Makes the geometry of a focused lens. Throws Error(wrong_arguments) unless all conditions are met:
/// - The focal length F is positive and finite.
/// - The f-number is positive. It is infinite for a pinhole.
/// - The focus distance s, which may be infinite, is greater than F. With Framing::keep, s need only be
///   greater than 0, because it does not determine the film distance.
[[nodiscard]] FocusGeometry focus_geometry(const ThinLens& lens, double focus_distance_m, Framing framing,
                                           const Film& film);

}  // namespace postlens
