// The f-numbers from which diffraction is wider than defocus or than a pixel.
#pragma once

#include <vector>

#include "lens/thin_lens.h"

namespace postlens {

/// Airy disc, CoC and pixel pitch on a film at V, and the f-numbers n at which they are equal. The Airy disc
/// is measured to its first zero, 2 * 1.2197 lambda V / D, and grows with n. The CoC V D |1/s - 1/z| falls
/// with n.
struct Crossover {
    struct Stop {
        double f_number = 0, airy_mm = 0, coc_mm = 0;
    };
    double over_defocus_f_number =
        0;                           ///< where Airy disc = CoC; 0 in focus, where diffraction is always wider
    double over_pixel_f_number = 0;  ///< where Airy disc = pixel pitch
    std::vector<Stop> stops;         ///< third stops from f/0.5 to f/128: n = 2^(i/6)
};

/// Throws Error(wrong_arguments) if F, s, depth, pitch or wavelength are out of range.
[[nodiscard]] Crossover crossover(double focal_length_mm, double focus_distance_m, double depth_m,
                                  double pixel_pitch_mm, double wavelength_nm);

}  // namespace postlens
