// Light near the focus of a circular aperture in closed form, by Lommel's functions. This is the slow
// reference version: it computes one point at a time, to full precision. radial_energy.h makes tables.
//
// u = (2 pi / lambda) (D/2)^2 (1/s - 1/z) is the defocus. v = pi r D / (lambda V) is proportional to the
// distance r from the geometric image, on a film at distance V. The geometric disc ends at v = |u|.
#pragma once

namespace postlens {

/// I(u, v) = |2 int_0^1 J0(v p) exp(-i u p^2 / 2) p dp|^2 [born1999, 8.8.1], the intensity relative to the
/// peak in focus: 1 at (0, 0). Even in u and v. Accepts any finite u and v, and needs O(v) steps. For |u| up
/// to 5000, the error is below 1e-12 and below 1e-9 of the response's peak.
[[nodiscard]] double lommel_intensity(double u, double v);

/// I(u, v) by Gauss-Legendre quadrature over panels of at most one fringe. Needs O(u + v) evaluations of a
/// Bessel function. `lommel_intensity` uses it for small u, and its tests use it as reference.
[[nodiscard]] double intensity_by_quadrature(double u, double v);

/// Share of the energy within radius v: (1/2) int_0^v I(u, v') v' dv', which is 1 for infinite v [born1999,
/// 8.8.3]. Needs O(v^2) steps. The error is below 1e-10 for |u| up to 1000.
[[nodiscard]] double lommel_encircled_energy(double u, double v);

/// Share of the energy beyond radius v, averaged over fringes: (2 / pi) v / (v^2 - u^2). Valid only well
/// outside the geometric disc: v - |u| must exceed both 8 sqrt(|u|) and 30. Derived from the first terms of
/// Lommel's functions for large v, with cos^2 replaced by its mean 1/2.
[[nodiscard]] double energy_beyond(double u, double v);

}  // namespace postlens
