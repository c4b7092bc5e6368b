// The thin lens: image distance, circle of confusion and depth of field. Lens lengths are in mm, scene
// distances in m.
#pragma once

#include <limits>
#include <optional>

namespace postlens {

/// A thin lens of focal length F and f-number n. The aperture's diameter is F / n.
struct ThinLens {
    double focal_length_mm = 50;  ///< > 0
    double f_number = 8;          ///< > 0; infinity is a pinhole
    [[nodiscard]] double aperture_diameter_mm() const { return focal_length_mm / f_number; }
};

/// Returns the film distance V = F s / (s - F), in mm, for focal length F and focus distance s [potmesil1981,
/// eq. 1]. It is F for infinite s, and infinite or negative for s <= F.
[[nodiscard]] double image_distance_mm(const ThinLens& lens, double focus_distance_m);

/// Returns the signed diameter of the circle of confusion, in mm, for focal length F, f-number n and focus
/// distance s > F [potmesil1981, eq. 3]:
///
///     F^2 (z - s) / (n z (s - F))
///
/// It is positive behind the focus, and finite even for infinite depth z.
[[nodiscard]] double coc_diameter_mm(const ThinLens& lens, double focus_distance_m, double depth_m);

/// The depths between which the circle of confusion is at most `coc_limit_mm` wide.
struct DepthOfField {
    double near_m = 0;
    double far_m =
        std::numeric_limits<double>::infinity();  ///< infinity at and beyond the hyperfocal distance
    double hyperfocal_m = 0;                      ///< F^2 / (n c) + F
};
[[nodiscard]] DepthOfField depth_of_field(const ThinLens& lens, double focus_distance_m, double coc_limit_mm);

}  // namespace postlens
