// Finds the f-numbers at which diffraction becomes wider than defocus blur or than a pixel.
#pragma once

#include <vector>

#include "lens/thin_lens.h"

namespace postlens {

/// Diameters of the Airy disc and the circle of confusion (CoC) at f-numbers in thirds of a stop:
/// - Airy disc, to its first zero: 2 * 1.2197 lambda V / D
/// - CoC: V D |1/s - 1/z|
///
/// V is the film distance, D the aperture diameter, s the focus distance and z the depth.
struct Crossover {
    struct Stop {
        double f_number = 0, airy_mm = 0, coc_mm = 0;
    };
    double over_defocus_f_number = 0;  ///< Airy disc = CoC; 0 in focus, where diffraction is always wider
    double over_pixel_f_number = 0;    ///< where Airy disc = pixel pitch
    std::vector<Stop> stops;           ///< third stops from f/0.5 to f/128: n = 2^(i/6)
};

/// Finds two f-numbers of a thin lens: from the first on, the Airy disc is wider than the circle of
/// confusion, and from the second on, it is wider than a pixel. Throws Error(wrong_arguments) if an argument
/// is out of range.
[[nodiscard]] Crossover crossover(double focal_length_mm, double focus_distance_m, double depth_m,
                                  double pixel_pitch_mm, double wavelength_nm);

}  // namespace postlens
