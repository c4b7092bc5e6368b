// The f-numbers at which diffraction becomes wider than defocus or than a pixel.
#pragma once

#include <vector>

#include "lens/thin_lens.h"

namespace postlens {

/// Diameters of Airy disc and CoC on a film at distance V, for f-numbers in steps of a third of a stop. Also
/// the f-numbers n at which the Airy disc equals the CoC, and at which it equals the pixel pitch. The Airy
/// disc is measured to its first zero, 2 * 1.2197 lambda V / D, and grows with n. The CoC is V D |1/s - 1/z|
/// and becomes smaller with n.
struct Crossover {
    struct Stop {
        double f_number = 0, airy_mm = 0, coc_mm = 0;
    };
    double over_defocus_f_number =
        0;                           ///< where Airy disc = CoC; 0 in focus, where diffraction is always wider
    double over_pixel_f_number = 0;  ///< where Airy disc = pixel pitch
    std::vector<Stop> stops;         ///< third stops from f/0.5 to f/128: n = 2^(i/6)
};

/// Throws Error(wrong_arguments) if focal length, focus distance, depth, pitch or wavelength is out of range.
[[nodiscard]] Crossover crossover(double focal_length_mm, double focus_distance_m, double depth_m,
                                  double pixel_pitch_mm, double wavelength_nm);

}  // namespace postlens
