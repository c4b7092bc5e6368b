// Computes the optical coordinates u and v of diffraction from lens, film and wavelength.
#pragma once

#include "lens/focus_geometry.h"
#include "lens/thin_lens.h"

namespace postlens {

/// Optical coordinates of one depth [born1999, 8.8.1].
struct WaveScale {
    double u = 0;         ///< defocus (2 pi / lambda) (D/2)^2 (1/s - 1/z); positive behind the focus
    double v_per_px = 0;  ///< v = pi r D / (lambda V) for r = one pixel; 0 for an aperture of width 0
};

/// Limits of accepted wavelengths, nm.
inline constexpr double shortest_wavelength_nm = 100, longest_wavelength_nm = 20000;

/// Throws Error(wrong_arguments) if the wavelength is not between these limits.
void check_wavelength(double wavelength_nm);

/// Largest |u| accepted. At larger |u|, fringes are narrower than a millionth of the disc, so the response
/// equals the geometric disc, and a table would take seconds.
inline constexpr double largest_u = 1e6;

/// Throws Error(wrong_arguments) if |u| exceeds largest_u or is not a number.
void check_defocus(double u);

/// Scale for a lens with its film at V (`lens psf`) and pixels of `pixel_pitch_mm`. u follows from the CoC in
/// px, u = v_per_px CoC / 2, so the edge of the geometric disc is at v = |u|. Needs s > F and a finite n.
[[nodiscard]] WaveScale wave_scale(const ThinLens& lens, double focus_distance_m, double depth_m,
                                   double pixel_pitch_mm, double wavelength_nm);

/// Scale for a traced film, which is at distance d for any focus. Aperture radius a and gain d / pitch give
/// v_per_px = 2 pi a / (lambda gain) and u = v_per_px coc_diameter_px / 2. Framing `breathing` has d = V, as
/// the function above. Framing `keep` uses the distance d of the traced film for Airy discs, of size lambda d
/// / D, as it does for the CoC.
[[nodiscard]] WaveScale wave_scale(const FocusGeometry& geometry, double inverse_depth_per_m,
                                   double wavelength_nm);

}  // namespace postlens
