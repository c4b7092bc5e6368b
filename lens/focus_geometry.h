// Converts lens points to displacements on the raster. All conversions between mm, m and px are in this file.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "lens/thin_lens.h"

namespace postlens {

enum class Framing {
    keep,       ///< F affects only the aperture; the field of view stays as traced
    lens,       ///< film distance F: the image is cropped or magnified
    breathing,  ///< film distance V = F s / (s - F) [potmesil1981]
};

/// The film of a trace.
struct Film {
    double distance_mm = 0;     ///< d, from the lens; > 0
    double pixel_pitch_mm = 0;  ///< > 0
};

/// Throws Error(wrong_arguments) unless both lengths are positive and finite.
void check_film(const Film& film);

/// A lens focused at distance s, for records that were traced through a pinhole. Seen from the lens point q
/// (m, raster axes), a point at inverse depth 1/z' is displaced by `gain_px * (1/s - 1/z') * q` px.
struct FocusGeometry {
    double aperture_radius_m = 0;    ///< F / (2 n); 0 is a pinhole
    double inverse_focus_per_m = 0;  ///< 1/s; 0 when focused at infinity
    double gain_px = 0;              ///< film distance d / pixel pitch, after framing, px
    double zoom = 1;                 ///< magnification of the raster about the image centre by the framing

    /// Signed diameter of the circle of confusion, px: positive for points behind the focus distance. Finite
    /// for every inverse depth.
    [[nodiscard]] double coc_diameter_px(double inverse_depth_per_m) const {
        return 2 * aperture_radius_m * gain_px * (inverse_focus_per_m - inverse_depth_per_m);
    }
};

/// Requires a finite F > 0, n > 0 (infinity: pinhole) and s > 0 (infinity allowed); s > F unless framing is
/// `keep`. Throws Error(wrong_arguments), with the reason, for values out of range.
[[nodiscard]] FocusGeometry focus_geometry(const ThinLens& lens, double focus_distance_m, Framing framing,
                                           const Film& film);

}  // namespace postlens
