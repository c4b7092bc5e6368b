// Light near the focus of a circular aperture in closed form, by Lommel's functions. This is the slow and
// simple version: one point at a time, to full precision. radial_energy.h makes tables.
//
// u = (2 pi / lambda) (D/2)^2 (1/s - 1/z) is the defocus, v = pi r D / (lambda V) the distance r from the
// geometric image on a film at V. The geometric disc ends at v = |u|.
#pragma once

namespace postlens {

/// I(u, v) = |2 int_0^1 J0(v p) exp(-i u p^2 / 2) p dp|^2 [born1999, 8.8.1], normalised to the peak in focus:
/// 1 at (0, 0). Even in u and v. Takes any finite u and v, in O(v) steps. For |u| up to 5000, the error is
/// below 1e-12 and below 1e-9 of the peak of the response.
[[nodiscard]] double lommel_intensity(double u, double v);

/// I(u, v) by Gauss-Legendre quadrature over panels no longer than a fringe. It is the reference for tests of
/// `lommel_intensity`, which uses it for small u. Takes O(u + v) evaluations of a Bessel function.
[[nodiscard]] double intensity_by_quadrature(double u, double v);

/// Share of the energy within radius v: (1/2) int_0^v I(u, v') v' dv', 1 for infinite v [born1999, 8.8.3].
/// Takes O(v^2) steps. Error below 1e-10 for |u| up to 1000.
[[nodiscard]] double lommel_encircled_energy(double u, double v);

/// Share of the energy beyond radius v, averaged over fringes: (2 / pi) v / (v^2 - u^2). Valid well outside
/// the edge, for v - |u| greater than 8 sqrt(|u|) and than 30. Derived from the first terms of Lommel's
/// functions for large v, with cos^2 replaced by its mean 1/2.
[[nodiscard]] double energy_beyond(double u, double v);

}  // namespace postlens
