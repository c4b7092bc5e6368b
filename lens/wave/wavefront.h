// Aberrations: how far the wave in the pupil is from a sphere around the image.
#pragma once

#include <vector>

namespace postlens {

/// One Zernike polynomial, normalised so that `waves_rms` is its root mean square over the unit disc
/// [born1999, 9.2]: n >= 0, |m| <= n, n - |m| even; cosines for m >= 0, sines for m < 0.
struct ZernikeTerm {
    int n = 0, m = 0;
    double waves_rms = 0;
};

/// Wavefront error W in waves over the pupil of radius 1. Of the sign of defocus: u is W = u p^2 / (4 pi), so
/// that what is positive ahead of the reference sphere at the edge of the pupil comes to its focus before the
/// film. Seidel's five as coefficients at the edge, the field along +x [born1999, 5.3], where positive
/// distortion moves the picture to +x:
/// W = spherical p^4 + coma p^3 cos(t) + astigmatism p^2 cos^2(t) + field_curvature p^2 + distortion p
/// cos(t).
struct Wavefront {
    double spherical = 0, coma = 0, astigmatism = 0, field_curvature = 0, distortion = 0;
    std::vector<ZernikeTerm> zernike;
};

/// Throws Error(wrong_arguments) for coefficients that are not finite or beyond 1e4 waves, and for n, m that
/// no polynomial has or n beyond 40.
void check_wavefront(const Wavefront& wavefront);

/// W at a point of the pupil, waves.
[[nodiscard]] double wavefront_waves(const Wavefront& wavefront, double x, double y);

/// The Zernike polynomial itself, of root mean square 1; p^2 = x^2 + y^2 <= 1.
[[nodiscard]] double zernike_polynomial(int n, int m, double x, double y);

}  // namespace postlens
