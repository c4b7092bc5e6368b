// From lens, film and wavelength to the two numbers that diffraction knows: u and v.
#pragma once

#include "lens/focus_geometry.h"
#include "lens/thin_lens.h"

namespace postlens {

/// Optical coordinates of one depth [born1999, 8.8.1].
struct WaveScale {
    double u = 0;         ///< defocus (2 pi / lambda) (D/2)^2 (1/s - 1/z); positive behind the focus
    double v_per_px = 0;  ///< v = pi r D / (lambda V) of r = one pixel; 0 for a pinhole without a width
};

/// The wavelengths that are taken for light, nm.
inline constexpr double shortest_wavelength_nm = 100, longest_wavelength_nm = 20000;

/// Throws Error(wrong_arguments) where the wavelength is not between the two.
void check_wavelength(double wavelength_nm);

/// Beyond it fringes are a millionth of the disc: the geometric disc is all there is to see, and a table of
/// waves would take seconds.
inline constexpr double largest_u = 1e6;

/// Throws Error(wrong_arguments) where |u| exceeds it or is not a number.
void check_defocus(double u);

/// For a lens with its film at V (`lens psf`), with pixels of `pixel_pitch_mm`. Both numbers hang on the CoC
/// alone: u = v_per_px |CoC| / 2 in px, so that the edge of the geometric disc is v = |u|.
/// Needs s > F, n finite.
[[nodiscard]] WaveScale wave_scale(const ThinLens& lens, double focus_distance_m, double depth_m,
                                   double pixel_pitch_mm, double wavelength_nm);

/// For a traced film: aperture radius a and gain d / pitch give v_per_px = 2 pi a / (lambda gain), the film
/// being at d whatever the focus is, and u = v_per_px coc_diameter_px / 2. Framing `breathing` has d = V, as
/// above; `keep` has Airy discs of the traced film's size, lambda d / D, as it has its CoC.
[[nodiscard]] WaveScale wave_scale(const FocusGeometry& geometry, double inverse_depth_per_m,
                                   double wavelength_nm);

}  // namespace postlens
