#include "focus/lens_views.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace postlens {
namespace {

double fraction(double v) {
    return v - std::floor(v);
}

}  // namespace

bool has_points(const Impulse& impulse) {
    return impulse.kind != ImpulseKind::diffraction && impulse.kind != ImpulseKind::lens;
}

void check_has_points(const Impulse& impulse) {
    check_impulse(impulse);
    if (has_points(impulse)) return;
    fail(ExitCode::wrong_arguments,
         "--impulse: lightfield, hybrid and shoot look from points of a thin lens, and {} (got {}; expected "
         "disc, polygon "
         "or image, or another method)",
         impulse.kind == ImpulseKind::lens ? "a real lens has others for every place of the field"
                                           : "waves have none",
         impulse_text(impulse));
}

std::vector<LensViewPoint> lens_view_points(const Aperture& aperture, const FocusGeometry& geometry,
                                            int views, int set) {
    if (views < 1 || views > most_lens_views) {
        fail(ExitCode::wrong_arguments, "--views: out of range (got {}; expected 1 to {})", views,
             most_lens_views);
    }
    // A Kronecker set: the golden ratio turns the spiral; the places go on along the powers of the plastic
    // number, the best such pair for two dimensions.
    constexpr double golden = 2 - std::numbers::phi;
    constexpr double plastic = 1.32471795724474602596;
    std::vector<LensViewPoint> out;
    out.reserve(static_cast<std::size_t>(views));
    for (int i = 0; i < views; ++i) {
        LensViewPoint p;
        // Sets differ by square roots, which have nothing to do with either number.
        const double u = (i + 0.5) / views, v = fraction(i * golden + set * std::numbers::sqrt2);
        if (aperture.is_round()) {
            const double angle = 2 * std::numbers::pi * v;
            p.lens = std::sqrt(u) * glm::dvec2(std::cos(angle), std::sin(angle));
        } else {
            p.lens = aperture.sample(u, v);
        }
        p.place = {fraction(0.5 + (i + 1) / plastic + set * std::numbers::sqrt3),
                   fraction(0.5 + (i + 1) / (plastic * plastic) +
                            set * (std::numbers::sqrt3 + std::numbers::sqrt2))};
        const glm::dvec2 q_px = geometry.gain_px * geometry.aperture_radius_m * p.lens;
        p.shift = {q_px, geometry.inverse_focus_per_m,
                   aperture.spherical_per_m() * glm::dot(p.lens, p.lens) * q_px};
        out.push_back(p);
    }
    return out;
}

}  // namespace postlens
