// Light near the focus of a circular aperture in closed form: Lommel's functions. Slow and obvious: one point
// at a time, to full precision. What tables are made with is radial_energy.h.
//
// u = (2 pi / lambda) (D/2)^2 (1/s - 1/z) is the defocus, v = pi r D / (lambda V) the distance r from the
// geometric image on a film at V. The geometric disc ends at v = |u|.
#pragma once

namespace postlens {

/// I(u, v) = |2 int_0^1 J0(v p) exp(-i u p^2 / 2) p dp|^2 [born1999, 8.8.1]; 1 at (0, 0), so normalised to
/// the peak in focus. Even in u and v. Any finite u and v; takes O(v) steps. Error below 1e-12 and below 1e-9
/// of the response's own peak for |u| up to 5000.
[[nodiscard]] double lommel_intensity(double u, double v);

/// The same integral by Gauss-Legendre quadrature over panels no longer than a fringe: the reference that
/// `lommel_intensity` is held against, and what it uses for small u. O(u + v) steps of a Bessel function
/// each.
[[nodiscard]] double intensity_by_quadrature(double u, double v);

/// The share of all energy within v: (1/2) int_0^v I(u, v') v' dv', 1 for v infinite [born1999, 8.8.3]. Takes
/// O(v^2) steps. Error below 1e-10 for |u| up to 1000.
[[nodiscard]] double lommel_encircled_energy(double u, double v);

/// What of the energy lies beyond v, without its fringes: (2 / pi) v / (v^2 - u^2), for v well outside of the
/// edge (v - |u| beyond 8 sqrt(|u|) and beyond 30). From the first terms of Lommel's functions for large v,
/// cos^2 replaced by its mean 1/2.
[[nodiscard]] double energy_beyond(double u, double v);

}  // namespace postlens
