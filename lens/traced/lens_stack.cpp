#include "lens/traced/lens_stack.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

// Moves a ray's origin along the ray to the plane z, near the lens. Intersections are imprecise if the origin
// is far away.
void begin_at(double z, LensRay& ray) {
    if (ray.direction.z != 0) ray.origin += (z - ray.origin.z) / ray.direction.z * ray.direction;
}

}  // namespace

LensStack::LensStack(const Prescription& lens, double wavelength_nm, double stop_radius_mm)
    : stop_(lens.stop()) {
    double z = 0, n = 1;
    elements_.reserve(lens.surfaces.size());
    for (const Surface& s : lens.surfaces) {
        Element e;
        e.z = z;
        e.c = s.curvature_per_mm;
        e.k = s.conic;
        e.asphere = s.asphere;
        e.is_asphere = s.is_asphere();
        const double after = s.glass.index(wavelength_nm);
        e.forward_ratio = n / after;
        e.backward_ratio = after / n;
        const double opening =
            s.is_stop && std::isfinite(stop_radius_mm) ? stop_radius_mm : s.clear_radius_mm;
        e.radius_squared = opening * opening;
        if (s.is_stop) stop_radius_mm_ = opening;
        elements_.push_back(e);
        z += s.thickness_mm;
        n = after;
    }
}

double LensStack::clear_radius_mm(std::size_t surface) const {
    return std::sqrt(elements_[surface].radius_squared);
}

RayFate LensStack::meet(const Element& e, LensRay& ray, double sign, Apertures apertures,
                        dvec3& normal) noexcept {
    const dvec3 d = ray.direction;
    dvec3 p = ray.origin - dvec3(0, 0, e.z);  // in the surface's own frame, with the vertex at the origin
    // If the ray's origin p is very far from the lens surface, rounding makes the intersection imprecise.
    // Therefore, p is moved along the ray to the point that is nearest to the surface's vertex. This step has
    // a rounding error too, so it is repeated once.
    constexpr double far_in_radii = 100;
    for (int i = 0; i < 2 && e.c * e.c * glm::dot(p, p) > far_in_radii * far_in_radii; ++i)
        p -= glm::dot(p, d) * d;
    const double q = 1 + e.k;
    // Finds the distance t at which the ray p + t d meets the lens surface c (x^2 + y^2 + q z^2) - 2 z = 0
    // [welford1986, 4.3]. c is the curvature at the vertex. Inserting the ray into this equation gives a t^2
    // - 2 b t + f = 0, with the coefficients a, b and f below.
    const double a = e.c * (1 + e.k * d.z * d.z);
    const double b = d.z - e.c * (p.x * d.x + p.y * d.y + q * p.z * d.z);
    const double f = e.c * (p.x * p.x + p.y * p.y + q * p.z * p.z) - 2 * p.z;
    const double discriminant = b * b - a * f;
    bool met = discriminant >= 0;
    if (met) {
        const double root = sign * std::sqrt(discriminant);
        // Moves p along the ray to the lens surface, by the distance t that solves a t^2 - 2 b t + f = 0. The
        // solution has two forms, f / (b + root) and (b - root) / a. If b and `root` nearly cancel in one of
        // them, the other is used, because it is more precise.
        const double divisor = b * sign >= 0 ? b + root : a;
        if (divisor != 0) p += (b * sign >= 0 ? f : b - root) / divisor * d;
        met = divisor != 0 || f == 0;
        // An ellipsoid has two halves, but the lens surface is only the half around the vertex. An
        // intersection with the other half therefore does not count.
        met = met && 1 - e.c * q * p.z > 0;
    }
    if (e.is_asphere) {
        // An aspheric surface is a conic that an even polynomial displaces along z. So far, p is the ray's
        // intersection with the conic alone. From there, Newton's method finds the intersection with the
        // displaced surface.
        constexpr int most_steps = 32;
        constexpr double close_mm = 1e-10;
        double miss = 0;
        for (int step = 0; step < most_steps; ++step) {
            const double r2 = p.x * p.x + p.y * p.y;
            const double root = std::sqrt(1 - q * e.c * e.c * r2);
            double sag = e.c * r2 / (1 + root);
            double slope = e.c / root;  // d sag / d r / r
            double power = 1;
            for (std::size_t i = 0; i < asphere_terms; ++i) {
                slope += 2 * static_cast<double>(i + 1) * e.asphere[i] * power;
                power *= r2;
                sag += e.asphere[i] * power;
            }
            normal = dvec3(-slope * p.x, -slope * p.y, 1);
            miss = p.z - sag;
            const double rate = d.z - slope * (p.x * d.x + p.y * d.y);
            if (!(std::abs(miss) > close_mm) || rate == 0) break;
            p -= miss / rate * d;
        }
        if (!(std::abs(miss) <= close_mm)) return RayFate::misses;  // also true for NaN
    } else {
        if (!met) return RayFate::misses;
        normal = dvec3(-e.c * p.x, -e.c * p.y, 1 - e.c * q * p.z);
    }
    if (e.k != 0 || e.is_asphere) {
        const double length = glm::length(normal);
        if (!std::isfinite(length)) return RayFate::misses;  // too steep for a double
        normal /= length;
    }
    ray.origin = p + dvec3(0, 0, e.z);
    // `inside` tells whether the ray meets the surface, at the point p, within the clear radius. If p is not
    // a number (NaN), `inside` is false, so the ray counts as vignetted.
    const bool inside = p.x * p.x + p.y * p.y <= e.radius_squared;
    if (apertures == Apertures::respected && !inside) return RayFate::vignetted;
    return RayFate::passes;
}

// Refracts a ray of direction d at a surface with normal N. By Snell's law, n' (d' x N) = n (d x N) for the
// refracted direction d'. `ratio` is n / n'. Returns false for total reflection.
bool LensStack::refract(dvec3& direction, const dvec3& normal, double ratio) noexcept {
    const double cosine = glm::dot(direction, normal);
    const double under_root = 1 - ratio * ratio * (1 - cosine * cosine);
    if (!(under_root >= 0)) return false;
    const double refracted = std::copysign(std::sqrt(under_root), cosine);
    direction = ratio * direction + (refracted - ratio * cosine) * normal;
    return true;
}

RayEnd LensStack::forward(LensRay& ray, Apertures apertures, std::span<dvec3> hits) const noexcept {
    dvec3 normal(0, 0, 1);
    begin_at(elements_.front().z, ray);
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const Element& e = elements_[i];
        const RayFate fate = meet(e, ray, 1, apertures, normal);
        if (!hits.empty()) hits[i] = ray.origin;
        if (fate != RayFate::passes) return {fate, i};
        if (e.forward_ratio != 1 && !refract(ray.direction, normal, e.forward_ratio)) {
            return {RayFate::reflected, i};
        }
    }
    return {};
}

RayEnd LensStack::backward(LensRay& ray, Apertures apertures, std::span<dvec3> hits) const noexcept {
    dvec3 normal(0, 0, 1);
    begin_at(elements_.back().z, ray);
    for (std::size_t i = elements_.size(); i-- > 0;) {
        const Element& e = elements_[i];
        const RayFate fate = meet(e, ray, -1, apertures, normal);
        if (!hits.empty()) hits[i] = ray.origin;
        if (fate != RayFate::passes) return {fate, i};
        if (e.backward_ratio != 1 && !refract(ray.direction, normal, e.backward_ratio)) {
            return {RayFate::reflected, i};
        }
    }
    return {};
}

dvec2 LensStack::at_stop(LensRay ray) const noexcept {
    const dvec2 nowhere(std::numeric_limits<double>::quiet_NaN());
    dvec3 normal(0, 0, 1);
    begin_at(elements_.front().z, ray);
    for (std::size_t i = 0; i <= stop_; ++i) {
        const Element& e = elements_[i];
        if (meet(e, ray, 1, Apertures::ignored, normal) != RayFate::passes) return nowhere;
        if (i == stop_) return {ray.origin};
        if (e.forward_ratio != 1 && !refract(ray.direction, normal, e.forward_ratio)) {
            return nowhere;
        }
    }
    return nowhere;
}

}  // namespace postlens
