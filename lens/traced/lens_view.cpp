#include "lens/traced/lens_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lens/traced/lit_outline.h"

namespace postlens {

using glm::dvec2;

namespace {

/// Number of chief rays (rays through the stop's centre) that are traced to measure the distortion of the
/// lens. With this many rays, cubic interpolation in the distortion table has a relative error below 1e-7.
constexpr std::size_t chief_rays = 257;
/// Tangent of a small angle from the axis, at which the image scale of the lens without distortion is
/// measured. The image scale is the distance of an image point from the film centre per tangent of the object
/// point's angle.
constexpr double small_tangent = 1e-4;

// Returns how far from the film centre, in mm, the chief ray of an object point lands. The chief ray is the
// ray that passes through the stop's centre. Returns a negative number if this ray cannot pass the lens
// surfaces.
double chief_radius_mm(const TracedLens& lens, double depth_m, double tangent) {
    const dvec2 field(0, tangent);
    const std::optional<dvec2> aim = lens.aim_at_stop(depth_m, field);
    if (!aim) return -1;
    LensRay chief = lens.object_ray(depth_m, field, *aim);
    if (!lens.stack().forward(chief, Apertures::ignored).passes()) return -1;
    return -lens.on_film(chief).y;
}

TracedLensSettings traced_settings(const LensViewSettings& s) {
    return {.focus_distance_m = s.focus_distance_m, .f_number = s.f_number, .wavelength_nm = std::nullopt};
}

}  // namespace

LensView::LensView(const Prescription& prescription, const LensViewSettings& settings) {
    const Film& film = settings.film;
    check_film(film);
    TracedLensSettings traced = traced_settings(settings);
    lens_.emplace(prescription, traced);
    const FirstOrder& first = lens_->first_order();
    film_scale_mm_ = chief_radius_mm(*lens_, settings.focus_distance_m, small_tangent) / small_tangent;
    double distance_mm = film.distance_mm;
    if (settings.framing == Framing::lens) distance_mm = first.efl_mm;
    if (settings.framing == Framing::breathing) distance_mm = film_scale_mm_;
    geometry_ = {
        .aperture_radius_m = 0.5e-3 * first.entrance_pupil_diameter_mm * first.f_number / lens_->f_number(),
        .inverse_focus_per_m = 1 / settings.focus_distance_m,
        .gain_px = distance_mm / film.pixel_pitch_mm,
        .zoom = distance_mm / film.distance_mm};
    const double widest = std::max(settings.half_diagonal_px / geometry_.gain_px, settings.widest_tangent);
    follow_chief_rays(*lens_, widest);
    // The factor 1.0001 keeps the image's corner inside despite rounding.
    traced.film_radius_mm = 1.0001 * film_radius_mm(widest);
    lens_.emplace(prescription, traced);
}

void LensView::follow_chief_rays(const TracedLens& lens, double widest_tangent) {
    tangent_step_ = widest_tangent / (chief_rays - 2);
    film_radius_.assign(1, 0);
    for (std::size_t i = 1; i < chief_rays; ++i) {
        const double before = film_radius_.back();
        double r = chief_radius_mm(lens, lens.settings().focus_distance_m.value_or(HUGE_VAL),
                                   tangent_step_ * static_cast<double>(i));
        // r is the distance from the film centre at which the chief ray lands, for a given field angle. If
        // the chief ray cannot pass the lens surfaces, or if r does not grow with the angle, the table of r
        // is continued linearly, so that it can be inverted.
        if (!(r > before)) {
            r = i == 1 ? film_scale_mm_ * tangent_step_ : 2 * before - film_radius_[i - 2];
        }
        film_radius_.push_back(r);
    }
}

double LensView::light(double tangent) const {
    ViewRay out;
    const auto weight = [&](const dvec2& at) {
        const dvec2 uv = at + 0.5;
        const bool inside = uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1;
        return inside && ray({0, tangent}, uv, out) ? out.weight : 0;
    };
    const LitOutline lit([&](const dvec2& at) { return weight(at) > 0; }, 0.25);
    std::array<dvec2, decltype(lit)::spokes + 1> edge;
    dvec2 middle(0);
    if (!lit.find(middle, edge)) return 0;
    double sum = 0;
    for (std::size_t j = 0; j + 1 < edge.size(); ++j) {
        const dvec2 a = edge[j] - middle, b = edge[j + 1] - middle;
        // The mean over the midpoints of a triangle's sides integrates second-degree polynomials exactly.
        const double mean =
            (weight(middle + a / 2.0) + weight(middle + b / 2.0) + weight(middle + (a + b) / 2.0)) / 3;
        sum += std::abs(a.x * b.y - a.y * b.x) / 2 * mean;
    }
    // `sum` is the light through one half of the region of lens points. The region is symmetric about x = 0,
    // so the other half transmits the same light.
    return 2 * sum;
}

// Returns how far from the film centre, in mm, the chief ray of an object point lands. `tangent` is the
// tangent of the point's angle from the axis. The result is interpolated in the distortion curve, which is
// continued linearly beyond its last entry.
double LensView::film_radius_mm(double tangent) const noexcept {
    const double at = tangent / tangent_step_;
    const std::size_t last = film_radius_.size() - 1;
    if (!(at < static_cast<double>(last))) {
        return film_radius_[last] +
               (at - static_cast<double>(last)) * (film_radius_[last] - film_radius_[last - 1]);
    }
    const auto i = static_cast<std::size_t>(at);
    const double f = at - static_cast<double>(i);
    const double p1 = film_radius_[i], p2 = film_radius_[i + 1];
    const double p0 = i == 0 ? -p2 : film_radius_[i - 1];
    const double p3 = i + 2 > last ? 2 * p2 - p1 : film_radius_[i + 2];
    return p1 + 0.5 * f * (p2 - p0 + f * (2 * p0 - 5 * p1 + 4 * p2 - p3 + f * (3 * (p1 - p2) + p3 - p0)));
}

double LensView::film_mm_per_tangent(double tangent) const noexcept {
    const double h = 0.5 * tangent_step_;
    const double below = tangent - h;
    return (film_radius_mm(tangent + h) - (below < 0 ? -film_radius_mm(-below) : film_radius_mm(below))) /
           (2 * h);
}

dvec2 LensView::straightened(dvec2 film_mm) const noexcept {
    const double r = glm::length(film_mm);
    if (r == 0) return dvec2(0);
    const auto above = std::upper_bound(film_radius_.begin(), film_radius_.end() - 1, r);
    const auto i = static_cast<double>(above - film_radius_.begin());
    double tangent = tangent_step_ * i;
    for (int step = 0; step < 8; ++step) {
        const double change = (r - film_radius_mm(tangent)) / film_mm_per_tangent(tangent);
        tangent = std::max(0.0, tangent + change);
        if (std::abs(change) <= 1e-13 * tangent) break;
    }
    return -tangent / r * film_mm;
}

bool LensView::ray(dvec2 tangent, dvec2 uv, ViewRay& out) const noexcept {
    const double t = glm::length(tangent);
    // Converts the direction that a pixel shows to a point on the film. The lens rotates the image by 180
    // degrees, which changes the signs of both coordinates. But y points down on the raster and up on the
    // film, so only the sign of x changes in total.
    const double scale = t > 0 ? film_radius_mm(t) / t : 0;
    SceneRay scene;
    if (!lens_->scene_ray({-scale * tangent.x, scale * tangent.y}, uv, scene)) return false;
    const dvec2 slope = dvec2(scene.direction) / -scene.direction.z;
    const dvec2 at = dvec2(scene.origin_mm) + scene.origin_mm.z * slope;
    out.lens_m = 1e-3 * dvec2(at.x, -at.y);
    out.tangent = {slope.x, -slope.y};
    out.weight = scene.weight;
    return true;
}

}  // namespace postlens
