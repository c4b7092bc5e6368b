// Computes the optical coordinates of diffraction, u (defocus) and v (radius), from the lens, the film and
// the wavelength.
#pragma once

#include "lens/focus_geometry.h"
#include "lens/thin_lens.h"

namespace postlens {

/// Optical coordinates of one depth [born1999, 8.8.1].
struct WaveScale {
    double u = 0;         ///< defocus (2 pi / lambda) (D/2)^2 (1/s - 1/z); positive behind the focus
    double v_per_px = 0;  ///< pi r D / (lambda V) for r = one pixel; 0 if the aperture has width 0
};

/// Throws Error(wrong_arguments) if the wavelength is outside [shortest_wavelength_nm,
/// longest_wavelength_nm].
void check_wavelength(double wavelength_nm);

/// Largest accepted |u|. For larger |u|, fringes are narrower than a millionth of the disc, so the geometric
/// disc is accurate.
inline constexpr double largest_u = 1e6;

/// Throws Error(wrong_arguments) if |u| exceeds largest_u or is not a number.
void check_defocus(double u);

/// Returns the scale for a lens with its film at distance V and pixels of `pixel_pitch_mm`. The edge of the
/// geometric disc is at v = |u|, because u = v_per_px CoC / 2 for a CoC diameter in px. Requires s > F and a
/// finite n.
[[nodiscard]] WaveScale wave_scale(const ThinLens& lens, double focus_distance_m, double depth_m,
                                   double pixel_pitch_mm, double wavelength_nm);

/// Returns the scale for the film of a traced image. The aperture radius is a, and gain is the film distance
/// d divided by the pixel pitch. Then v_per_px is 2 pi a / (lambda gain), and u is v_per_px coc_diameter_px /
/// 2. With framing `breathing`, d is V as in the function above. With framing `keep`, d is the film distance
/// of the trace and does not depend on the focus.
[[nodiscard]] WaveScale wave_scale(const FocusGeometry& geometry, double inverse_depth_per_m,
                                   double wavelength_nm);

}  // namespace postlens
