// Computes the optical coordinates of diffraction: u (defocus) and v (radius).
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

/// Largest accepted |u|, the defocus in optical units. Beyond it, diffraction fringes are narrower than a
/// millionth of the blur disc, and the disc of geometric optics is accurate.
inline constexpr double largest_u = 1e6;

/// Throws Error(wrong_arguments) if |u| exceeds largest_u or is not a number.
void check_defocus(double u);

/// Returns the optical coordinates of diffraction theory for a scene point at `depth_m`: the defocus u, and
/// v_per_px, which converts a radius in the image from px to the coordinate v. The lens is thin, has a finite
/// f-number, and is focused beyond its focal length. The geometric blur disc ends at v = |u|.
[[nodiscard]] WaveScale wave_scale(const ThinLens& lens, double focus_distance_m, double depth_m,
                                   double pixel_pitch_mm, double wavelength_nm);

/// Returns the optical coordinates of diffraction theory for a point of a traced image. With the wavelength
/// lambda, the aperture radius a and the film distance gain_px in px, the width of a pixel is v_per_px = 2 pi
/// a / (lambda gain_px). The defocus is u = v_per_px coc_diameter_px / 2, with the diameter of the circle of
/// confusion.
[[nodiscard]] WaveScale wave_scale(const FocusGeometry& geometry, double inverse_depth_per_m,
                                   double wavelength_nm);

}  // namespace postlens
