#include "lens/traced/lens_models.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace postlens {
namespace {

using glm::dvec2;

constexpr int error_nodes = 81;

}  // namespace

const char* name_of(LensModelKind kind) {
    static constexpr std::array<const char*, lens_model_kinds> names{"thin", "thick", "polynomial", "traced"};
    return names[static_cast<std::size_t>(kind)];
}

void PolynomialLens::terms(double u, double v, double T, double K, std::array<double, polynomial_terms>& x,
                           std::array<double, polynomial_terms>& y) {
    const double r2 = u * u + v * v, T2 = T * T;
    // `of_x` and `of_y` are the terms of two polynomials, which predict where a ray that crosses the pupil at
    // (u, v) lands on the film. Because the lens is symmetric, every term of x contains an odd power of u. In
    // `of_x`, a factor u is left out, which is multiplied below.
    const std::array<double, pupil_terms> of_x{
        1,          T2,         T2 * T2,    r2,           r2 * T2,         r2 * r2,     v * T,
        v * T * T2, v * T * r2, v * v * T2, r2 * T2 * T2, v * T * T2 * T2, r2 * r2 * r2};
    const std::array<double, pupil_terms> of_y{
        v,      v * T2,    v * T2 * T2,           v * r2,         v * r2 * T2,     v * r2 * r2, T, T * T2,
        r2 * T, v * v * T, (r2 + v * v) * T * T2, v * v * v * T2, v * r2 * r2 * r2};
    for (std::size_t i = 0; i < pupil_terms; ++i) {
        x[i] = u * of_x[i];
        y[i] = of_y[i];
        x[pupil_terms + i] = K * x[i];
        y[pupil_terms + i] = K * y[i];
    }
}

ModelRay PolynomialLens::ray(double depth_m, double tangent, dvec2 pupil_mm) const {
    const dvec2 p = pupil_mm / pupil_radius_mm;
    const double T = tangent / largest_tangent;
    const double K = (1 / depth_m - inverse_focus_per_m) / largest_defocus_per_m;
    ModelRay out;
    out.passes = std::all_of(circles.begin(), circles.end(), [&](const PupilCircle& c) {
        const double radius = c.radius + c.radius_by_depth * K + c.growth * T * T;
        const double y = p.y - (c.shift + c.shift_by_depth * K) * T - c.bend * T * T * T;
        return radius > 0 && p.x * p.x + y * y <= radius * radius;
    });
    std::array<double, polynomial_terms> x{}, y{};
    terms(p.x, p.y, T, K, x, y);
    for (std::size_t i = 0; i < polynomial_terms; ++i) out.film_mm += dvec2(x_mm[i] * x[i], y_mm[i] * y[i]);
    return out;
}

LensModelRange lens_model_range(const TracedLens& lens, double a_m, double b_m, double field_mm, int count) {
    if (!(a_m > 0 && b_m > a_m) || std::isinf(a_m)) {
        fail(ExitCode::wrong_arguments,
             "--depths: out of range (got {}:{}; expected A:B in metres, A more than 0 and less than B)", a_m,
             b_m);
    }
    if (!(field_mm >= 0) || !std::isfinite(field_mm)) {
        fail(ExitCode::wrong_arguments, "--field: out of range (got {} mm; expected 0 or more)", field_mm);
    }
    LensModelRange out;
    for (int i = 0; i < count; ++i) {
        const double share = static_cast<double>(i) / (count - 1);
        const double inverse = 1 / a_m * (1 - share) + 1 / b_m * share;
        out.depths_m.push_back(inverse > 0 ? 1 / inverse : b_m);
    }
    // Returns how far from the film centre the chief ray of an object point at infinity lands. The chief ray
    // passes through the centre of the stop. The object point's angle from the axis is given by its tangent.
    // If the ray is blocked, the result is infinity.
    const auto height = [&lens](double tangent) {
        const auto aim = lens.aim_at_stop(HUGE_VAL, {0, tangent});
        if (!aim) return HUGE_VAL;
        LensRay ray = lens.object_ray(HUGE_VAL, {0, tangent}, *aim);
        if (!lens.stack().forward(ray, Apertures::ignored).passes()) return HUGE_VAL;
        return std::abs(lens.on_film(ray).y);
    };
    // Searches for the field angle (angle of an object point from the axis) at which the chief ray lands
    // field_mm from the film centre. The angle grows in steps of one degree, and is then refined by
    // bisection. The search ends early if the ray is blocked or does not land farther out.
    double low = 0, reached_mm = 0;
    const auto grows = [&](double tangent) {
        const double mm = height(tangent);
        if (!(mm >= reached_mm && mm < field_mm)) return false;
        low = tangent;
        reached_mm = mm;
        return true;
    };
    double high = 0;
    for (int deg = 1; deg <= 89; ++deg) {
        high = std::tan(deg * std::numbers::pi / 180);
        if (!grows(high)) break;
    }
    for (int step = 0; step < 80 && high - low > 1e-12; ++step) {
        const double middle = 0.5 * (low + high);
        if (!grows(middle)) high = middle;
    }
    if (field_mm > 0 && std::abs(reached_mm - field_mm) > 1e-6 * field_mm) {
        fail(ExitCode::wrong_arguments,
             "--field: no chief ray lands so far from the centre (got {} mm; expected at most "
             "about {:.4g} mm)",
             field_mm, reached_mm);
    }
    for (int i = 0; i < count; ++i) {
        out.tangents.push_back(low * i / (count - 1));
        if (field_mm == 0) break;
    }
    return out;
}

LensModels::LensModels(const Prescription& lens, const TracedLens& traced) : traced_(&traced) {
    const FirstOrder& f = traced.first_order();
    pupil_radius_mm_ = 0.5 * f.entrance_pupil_diameter_mm * f.f_number / traced.f_number();
    // `landing` returns the height, in mm, at which a paraxial ray meets the film. The ray starts at an
    // object point on the axis and crosses the entrance pupil at the height 1 mm. If the object point is in
    // focus, the height on the film is 0.
    const double nm = traced.wavelength_nm(), film = traced.film_distance_mm();
    const std::size_t last = lens.surfaces.size() - 1;
    const auto landing = [&](double inverse_depth_per_mm) {
        const double pupil_z = f.entrance_pupil_z_mm;
        const ParaxialRay end =
            paraxial_ray(lens, nm, {1 - pupil_z * inverse_depth_per_mm, inverse_depth_per_mm}, last);
        return end.y_mm + end.nu * film / lens.image_index(nm);
    };
    thick_at_infinity_ = landing(0);
    thick_per_depth_m_ = 1e-3 * (landing(1) - landing(0));
    // `own` is the inverse focus distance, in 1/m, to which the film's position corresponds. A paraxial ray
    // from an object point on the axis, at the inverse depth x, meets the film at the height
    // thick_at_infinity_ + thick_per_depth_m_ x. This height is 0 for a point in focus.
    const double own = -thick_at_infinity_ / thick_per_depth_m_;
    const auto set = traced.settings().focus_distance_m;
    inverse_focus_per_m_ = set ? 1 / *set : std::abs(own) < 1e-9 ? 0 : own;
    const double F = f.efl_mm;
    thin_film_mm_ = inverse_focus_per_m_ == 0 ? F : F / (1 - F * 1e-3 * inverse_focus_per_m_);
}

ModelRay LensModels::ray(LensModelKind kind, double depth_m, double tangent, dvec2 pupil_mm) const {
    const bool in_disc = glm::dot(pupil_mm, pupil_mm) <= pupil_radius_mm_ * pupil_radius_mm_;
    switch (kind) {
        case LensModelKind::thin:
            return {pupil_mm * (thin_film_mm_ * 1e-3 * (1 / depth_m - inverse_focus_per_m_)), in_disc};
        case LensModelKind::thick:
            return {pupil_mm * (thick_at_infinity_ + thick_per_depth_m_ / depth_m), in_disc};
        case LensModelKind::polynomial:
            return polynomial_ ? polynomial_->ray(depth_m, tangent, pupil_mm) : ModelRay{};
        case LensModelKind::traced:
            break;
    }
    LensRay traced = traced_->object_ray(depth_m, {0, tangent}, pupil_mm);
    const bool passes = traced_->stack().forward(traced).passes();
    return {passes ? traced_->on_film(traced) : dvec2(0), passes};
}

double LensModels::error_mm(LensModelKind kind, double depth_m, double tangent) const {
    if (kind == LensModelKind::traced) return 0;
    PupilMesh mesh;
    const bool any = traced_->impulse(depth_m, {0, tangent}, 2, mesh);
    dvec2 low(-1.2 * pupil_radius_mm_), high(1.2 * pupil_radius_mm_);
    if (any) {
        low = glm::min(low, mesh.pupil_mm.front());
        high = glm::max(high, mesh.pupil_mm.back());
    }
    struct Node {
        dvec2 pupil{0}, film{0};
    };
    std::vector<Node> both, one;
    double sum = 0;
    for (int j = 0; j < error_nodes; ++j) {
        for (int i = 0; i < error_nodes; ++i) {
            const dvec2 p = low + (high - low) * dvec2(i, j) / static_cast<double>(error_nodes - 1);
            const ModelRay model = ray(kind, depth_m, tangent, p);
            const ModelRay exact = ray(LensModelKind::traced, depth_m, tangent, p);
            if (!model.passes && !exact.passes) continue;
            const dvec2 landed = exact.passes ? exact.film_mm - mesh.chief_film_mm : model.film_mm;
            if (model.passes && exact.passes) {
                const dvec2 off = landed - model.film_mm;
                sum += glm::dot(off, off);
                both.push_back({p, landed});
            } else {
                one.push_back({p, landed});
            }
        }
    }
    // `one` contains the rays that pass either the traced lens or the lens model, but not both. Such a ray
    // has no second landing point for comparison. Therefore, its landing point is compared with the traced
    // landing point of the nearest ray in the pupil that passes both.
    for (const Node& node : one) {
        dvec2 off = node.film;
        double nearest = HUGE_VAL;
        for (const Node& other : both) {
            const dvec2 away = other.pupil - node.pupil;
            if (glm::dot(away, away) >= nearest) continue;
            nearest = glm::dot(away, away);
            off = other.film - node.film;
        }
        sum += glm::dot(off, off);
    }
    const auto count = static_cast<double>(both.size() + one.size());
    return count > 0 ? std::sqrt(sum / count) : 0;
}

double LensModels::error_mm(LensModelKind kind, const LensModelRange& range) const {
    double worst = 0;
    for (const double depth : range.depths_m) {
        for (const double tangent : range.tangents) worst = std::max(worst, error_mm(kind, depth, tangent));
    }
    return worst;
}

}  // namespace postlens
