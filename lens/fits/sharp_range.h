// Finds the focus distance and f-numbers for which everything between two depths is sharp.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct SharpRangeRequest {
    double near_m = 1, far_m = 2;           ///< 0 < near < far, far may be infinite
    double coc_limit_mm = 0.03;             ///< > 0
    std::optional<double> focal_length_mm;  ///< absent: common focal lengths from 14 to 300 mm
    double wavelength_nm = 550;
};

/// Result for one focal length.
struct SharpLens {
    double focal_length_mm = 0;
    double f_number = 0;          ///< smallest f-number that keeps the range sharp
    double largest_f_number = 0;  ///< f-number at which the Airy disc is as wide as the CoC limit
    std::string why_not;          ///< reason why no f-number works; empty if one does
};

struct SharpRange {
    double focus_distance_m = 0;
    std::vector<SharpLens> lenses;
};

/// Finds the focus distance s and the f-number n whose depth of field is exactly the given range, for focal
/// length F and CoC limit c:
///
///     s = 2 / (1/near + 1/far),  n = F^2 (1/near - 1/far) / (2 c (1 - F/s))
///
/// n is at least 0.7. Throws Error(wrong_arguments) for numbers out of range.
[[nodiscard]] SharpRange sharp_range(const SharpRangeRequest& request);

}  // namespace postlens
