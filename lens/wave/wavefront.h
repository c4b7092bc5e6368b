// Aberrations: deviation of the wavefront in the pupil from a sphere around the image point.
#pragma once

#include <vector>

namespace postlens {

/// One Zernike polynomial, normalised so that `waves_rms` is its root mean square over the unit disc
/// [born1999, 9.2]. n >= 0, |m| <= n and n - |m| is even; m >= 0 selects cosines, m < 0 sines.
struct ZernikeTerm {
    int n = 0, m = 0;
    double waves_rms = 0;
};

/// Wavefront error W in waves over the pupil of radius 1, at radius p and angle t. Its sign is that of
/// defocus, W = u p^2 / (4 pi): where W grows towards the edge of the pupil, light is focused in front of the
/// film. The five Seidel aberrations are given by their values at the edge, for a field along +x [born1999,
/// 5.3]: W = spherical p^4 + coma p^3 cos(t) + astigmatism p^2 cos^2(t) + field_curvature p^2 + distortion p
/// cos(t). Positive distortion displaces the image towards +x.
struct Wavefront {
    double spherical = 0, coma = 0, astigmatism = 0, field_curvature = 0, distortion = 0;
    std::vector<ZernikeTerm> zernike;
};

/// Throws Error(wrong_arguments) for a coefficient that is not finite or exceeds 1e4 waves, for n and m
/// without a Zernike polynomial, and for n above 40.
void check_wavefront(const Wavefront& wavefront);

/// W at a point of the pupil, waves.
[[nodiscard]] double wavefront_waves(const Wavefront& wavefront, double x, double y);

/// Value at (x, y) of a Zernike polynomial with root mean square 1 over the unit disc; p^2 = x^2 + y^2 <= 1.
[[nodiscard]] double zernike_polynomial(int n, int m, double x, double y);

}  // namespace postlens
