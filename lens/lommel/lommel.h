// Light near the focus of a circular aperture, computed by Lommel's functions. This is a slow reference:
// radial_energy.h computes the same energies faster, from tables. A point near the focus is described by
// optical coordinates. They depend on the wavelength lambda, the aperture diameter D and the film distance V:
// - defocus u = (2 pi / lambda) (D/2)^2 (1/s - 1/z), for the focus distance s and the depth z
// - radius v = pi r D / (lambda V), at the distance r from the centre; the geometric disc ends at v = |u|
#pragma once

namespace postlens {

/// Returns the diffraction intensity at defocus u and radius v (optical units), relative to the peak in focus
/// [born1999, 8.8.1]:
///
///     I(u, v) = |2 int_0^1 J0(v p) exp(-i u p^2 / 2) p dp|^2
///
/// Needs O(v) steps. For |u| up to 5000, the error is below 1e-12.
[[nodiscard]] double lommel_intensity(double u, double v);

/// Returns the same as lommel_intensity(u, v), computed by Gauss-Legendre quadrature in O(u + v) steps. Used
/// for small defocus u and as a reference for tests.
[[nodiscard]] double intensity_by_quadrature(double u, double v);

/// Returns the fraction of the light within radius v at defocus u: (1/2) int_0^v I(u, v') v' dv' [born1999,
/// 8.8.3], where I is lommel_intensity. Needs O(v^2) steps. The error is below 1e-10 for |u| up to 1000.
[[nodiscard]] double lommel_encircled_energy(double u, double v);

/// Returns the fraction of a point's light that diffraction spreads beyond the radius v at the defocus u
/// (both in optical units):
///
///     (2 / pi) v / (v^2 - u^2)
///
/// The formula ignores diffraction fringes: it is the mean over them, derived from Lommel's functions for
/// large v. It is valid only if v - |u| exceeds both 8 sqrt(|u|) and 30.
[[nodiscard]] double energy_beyond(double u, double v);

}  // namespace postlens
