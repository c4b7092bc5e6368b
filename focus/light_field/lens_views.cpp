#include "focus/light_field/lens_views.h"

#include "core/error.h"
#include "core/sobol.h"

namespace postlens {
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
                                            int views, int set, int first) {
    if (views < 1 || first < 0 || views > most_lens_views - first) {
        fail(ExitCode::wrong_arguments, "--views: out of range (got {}; expected 1 to {})", views,
             most_lens_views);
    }
    const SetKey key{static_cast<std::uint64_t>(set)};
    const auto coordinate = [&](int dimension, int i) {
        const std::uint32_t seed = low_word(key.stream(static_cast<std::uint32_t>(dimension)));
        const std::uint32_t bits = sobol_reversed(dimension, static_cast<std::uint32_t>(i));
        return static_cast<double>(reverse_bits(owen_scramble_reversed(bits, seed))) * 0x1p-32;
    };
    std::vector<LensViewPoint> out;
    out.reserve(static_cast<std::size_t>(views));
    for (int i = first; i < first + views; ++i) {
        LensViewPoint p;
        const double u = coordinate(2, i), v = coordinate(3, i);
        p.lens = aperture.is_round() ? disc_point(u, v) : aperture.sample(u, v);
        p.place = {coordinate(0, i), coordinate(1, i)};
        p.light_before = coordinate(4, i);
        const glm::dvec2 q_px = geometry.gain_px * geometry.aperture_radius_m * p.lens;
        p.shift = {q_px, geometry.inverse_focus_per_m,
                   aperture.spherical_per_m() * glm::dot(p.lens, p.lens) * q_px};
        out.push_back(p);
    }
    return out;
}

}  // namespace postlens
