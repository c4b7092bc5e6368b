// The thin lens: image distance, circle of confusion, depth of field. Lens in mm, scene in m.
#pragma once

#include <limits>
#include <optional>

namespace postlens {

/// A thin lens of focal length F and f-number n; its aperture has the diameter F / n.
struct ThinLens {
    double focal_length_mm = 50;  ///< > 0
    double f_number = 8;          ///< > 0; infinity is a pinhole
    [[nodiscard]] double aperture_diameter_mm() const { return focal_length_mm / f_number; }
};

/// Film distance V = F s / (s - F), mm [potmesil1981, eq. 1]. V = F for an infinite s. Infinite or negative
/// for s <= F.
[[nodiscard]] double image_distance_mm(const ThinLens& lens, double focus_distance_m);

/// Signed diameter of the circle of confusion on a film at distance V(s), mm: F^2 (z - s) / (n z (s - F))
/// [potmesil1981, eq. 3]. Positive for points behind the focus, negative in front. Finite for every depth_m >
/// 0, including infinity. Requires s > F.
[[nodiscard]] double coc_diameter_mm(const ThinLens& lens, double focus_distance_m, double depth_m);

/// Depths between which the circle of confusion is at most `coc_limit_mm` wide.
struct DepthOfField {
    double near_m = 0;
    double far_m =
        std::numeric_limits<double>::infinity();  ///< infinity at and beyond the hyperfocal distance
    double hyperfocal_m = 0;                      ///< F^2 / (n c) + F
};
[[nodiscard]] DepthOfField depth_of_field(const ThinLens& lens, double focus_distance_m, double coc_limit_mm);

}  // namespace postlens
