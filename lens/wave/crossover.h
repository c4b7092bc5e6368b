// From which f-number on diffraction is wider than defocus or than a pixel.
#pragma once

#include <vector>

#include "lens/thin_lens.h"

namespace postlens {

/// Three diameters on a film at V, and where they cross as the lens is stopped down. The Airy disc is
/// measured to its first zero, 2 * 1.2197 lambda V / D: it grows with n; the CoC V D |1/s - 1/z| falls with
/// it.
struct Crossover {
    struct Stop {
        double f_number = 0, airy_mm = 0, coc_mm = 0;
    };
    double over_defocus_f_number = 0;  ///< Airy = CoC; 0 in focus, where diffraction is always wider
    double over_pixel_f_number = 0;    ///< Airy = pixel pitch
    std::vector<Stop> stops;           ///< third stops from f/0.5 to f/128: n = 2^(i/6)
};

/// The f-number of `lens` plays no part. Throws Error(wrong_arguments) for F, s, depth, pitch and wavelength
/// out of range.
[[nodiscard]] Crossover crossover(double focal_length_mm, double focus_distance_m, double depth_m,
                                  double pixel_pitch_mm, double wavelength_nm);

}  // namespace postlens
