// A lens that is sharp from one depth to another.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct SharpRangeRequest {
    double near_m = 1, far_m = 2;           ///< 0 < near < far, far may be infinite
    double coc_limit_mm = 0.03;             ///< > 0
    std::optional<double> focal_length_mm;  ///< absent: usual ones from 14 to 300 mm
    double wavelength_nm = 550;
};

/// One focal length's answer.
struct SharpLens {
    double focal_length_mm = 0;
    double f_number = 0;          ///< the widest aperture that will do; at smaller ones more is sharp
    double largest_f_number = 0;  ///< where the Airy disc is as wide as the limit
    std::string why_not;          ///< empty: it does
};

struct SharpRange {
    double focus_distance_m = 0;
    std::vector<SharpLens> lenses;
};

/// Solves near(F, n, s) = near and far(F, n, s) = far of `depth_of_field` for s and n: s = 2 / (1/near +
/// 1/far), whatever the lens; n = F^2 (1/near - 1/far) / (2 c (1 - F/s)), at least 0.7. A lens will not do
/// where F reaches the near limit and where diffraction at that n is wider than the limit. Throws
/// Error(wrong_arguments) for numbers out of range.
[[nodiscard]] SharpRange sharp_range(const SharpRangeRequest& request);

}  // namespace postlens
