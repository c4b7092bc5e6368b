#include "lens/wave/wavefront.h"

#include <cmath>
#include <cstdlib>

#include "core/error.h"

namespace postlens {
namespace {

constexpr int most_n = 40;  // above this, the sum of the radial polynomial loses precision
constexpr double most_waves = 1e4;

void check_waves(double waves) {
    if (std::abs(waves) <= most_waves) return;
    fail(ExitCode::wrong_arguments, "aberration is out of range (got {} waves; expected -{} to {})", waves,
         most_waves, most_waves);
}

/// Radial polynomial R_n^m(p), summed term by term [born1999, 9.2, eq. 5].
double radial_polynomial(int n, int m, double p) {
    double sum = 0;
    for (int k = 0; k <= (n - m) / 2; ++k) {
        const double log_size = std::lgamma(n - k + 1) - std::lgamma(k + 1) -
                                std::lgamma((n + m) / 2 - k + 1) - std::lgamma((n - m) / 2 - k + 1);
        const double term = std::round(std::exp(log_size)) * std::pow(p, n - 2 * k);
        sum += k % 2 == 0 ? term : -term;
    }
    return sum;
}

}  // namespace

void check_wavefront(const Wavefront& w) {
    for (const double waves : {w.spherical, w.coma, w.astigmatism, w.field_curvature, w.distortion}) {
        check_waves(waves);
    }
    for (const ZernikeTerm& term : w.zernike) {
        check_waves(term.waves_rms);
        if (term.n < 0 || term.n > most_n || std::abs(term.m) > term.n || (term.n - term.m) % 2 != 0) {
            fail(ExitCode::wrong_arguments,
                 "no such Zernike polynomial (got n = {}, m = {}; expected n from 0 to {}, |m| <= n, n - m "
                 "even)",
                 term.n, term.m, most_n);
        }
    }
}

double zernike_polynomial(int n, int m, double x, double y) {
    const double p = std::hypot(x, y), angle = std::atan2(y, x);
    const int order = std::abs(m);
    const double norm = std::sqrt((m == 0 ? 1.0 : 2.0) * (n + 1));
    return norm * radial_polynomial(n, order, p) *
           (m >= 0 ? std::cos(order * angle) : std::sin(order * angle));
}

double wavefront_waves(const Wavefront& w, double x, double y) {
    const double p2 = x * x + y * y;
    double sum = w.spherical * p2 * p2 + w.coma * p2 * x + w.astigmatism * x * x + w.field_curvature * p2 +
                 w.distortion * x;
    for (const ZernikeTerm& term : w.zernike)
        sum += term.waves_rms * zernike_polynomial(term.n, term.m, x, y);
    return sum;
}

}  // namespace postlens
