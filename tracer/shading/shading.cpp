#include "tracer/shading/shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace postlens {

using glm::dvec2;
using glm::dvec3;

double largest(const dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

Facing face(const SurfacePoint& s, const dvec3& direction) {
    const double sign = glm::dot(direction, s.geometric_normal) < 0 ? 1 : -1;
    Facing f{sign * s.normal, sign * s.geometric_normal, sign, true};
    if (glm::dot(direction, f.normal) >= 0) {
        // The interpolated normal faces away from the ray, so no mirror direction can be computed from it.
        // The geometric normal replaces it.
        f.normal = f.geometric_normal;
        f.smooth = false;
    }
    return f;
}

dvec3 surface_colour(const Material& m, const SurfacePoint& s) {
    const dvec3 corners(s.colour);
    return m.colour_texture ? corners * m.colour_texture->colour(s.object_position, s.uv) : corners;
}

dvec3 own_radiance(const Scene& scene, const Material& m, const SurfacePoint& s, const dvec3& colour) {
    dvec3 out = m.ambient * colour * scene.ambient_light;
    const dvec3 emission = m.emission_has_colour ? m.emission * colour : m.emission;
    out += m.emission_texture ? emission * m.emission_texture->colour(s.object_position, s.uv) : emission;
    return out;
}

PlacedLight place_light(const Light& l, const glm::dmat4& motion) {
    const auto cosine = [](double full_degrees) { return std::cos(full_degrees * std::numbers::pi / 360); };
    const auto turned = [&](const dvec3& v) { return dvec3(motion * glm::dvec4(v, 0)); };
    return {&l,
            dvec3(motion * glm::dvec4(l.position, 1)),
            glm::normalize(turned(l.direction)),
            turned(l.edge_u),
            turned(l.edge_v),
            cosine(l.cone_degrees),
            cosine(std::min(l.cone_soft_degrees, l.cone_degrees))};
}

PlacedLight place_light(const Light& l, double time_s) {
    return place_light(l, l.keys.empty() ? glm::dmat4(1) : transform_at(l.keys, time_s));
}

dvec3 light_point(const PlacedLight& placed, const dvec3& from, const dvec2& uv) {
    const Light& l = *placed.light;
    if (l.kind == Light::Kind::rectangle) {
        return placed.position + (uv.x - 0.5) * placed.edge_u + (uv.y - 0.5) * placed.edge_v;
    }
    if (l.kind != Light::Kind::sphere) return placed.position;
    const dvec3 to_centre = placed.position - from;
    const double distance2 = glm::dot(to_centre, to_centre), sine2 = l.radius * l.radius / distance2;
    if (!(sine2 < 1)) return placed.position;  // `from` is inside the sphere, from where there is no outline
    // Chooses a direction to the spherical light, uniformly from the cone of directions in which it is
    // visible. The cone has the half angle a, and `widest` is 1 - cos a. It is computed from sin^2 a, because
    // 1 - cos a would lose digits by cancellation.
    const double widest = sine2 / (1 + std::sqrt(1 - sine2));
    const double lowered = uv.x * widest, cosine = 1 - lowered;
    const double sine = std::sqrt(std::max(0.0, lowered * (2 - lowered))), turn = 2 * std::numbers::pi * uv.y;
    const double distance = std::sqrt(distance2);
    const dvec3 z = to_centre / distance;
    const dvec3 hint = std::abs(z.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 x = glm::normalize(hint - z * glm::dot(hint, z)), y = glm::cross(z, x);
    const dvec3 direction = sine * std::cos(turn) * x + sine * std::sin(turn) * y + cosine * z;
    const double across2 = distance2 * sine * sine;
    return from + (distance * cosine - std::sqrt(std::max(0.0, l.radius * l.radius - across2))) * direction;
}

double schlick_weight(double cosine) {
    const double c = 1 - std::clamp(cosine, 0.0, 1.0), c2 = c * c;
    return c2 * c2 * c;
}

namespace {

// Returns the specular coefficient of the highlight that a light causes on a material. If the material has
// `fresnel`, the coefficient depends on the angle at which the light meets the surface's microfacets. The
// normal of the microfacets that reflect it is halfway between the directions to the light and to the eye.
dvec3 highlight(const Material& m, const dvec3& to_light, const dvec3& direction) {
    if (!m.fresnel) return m.specular;
    const dvec3 half = to_light - direction;
    const double length = glm::length(half);
    if (!(length > 0)) return m.specular_grazing;
    return glm::mix(m.specular, m.specular_grazing, schlick_weight(glm::dot(half, to_light) / length));
}

}  // namespace

Lit lit_by(const PlacedLight& placed, const dvec3& at, const SurfacePoint& s, const Facing& f,
           const Material& m, const dvec3& colour, const dvec3& direction) {
    const Light& l = *placed.light;
    Lit out;
    const bool directional = l.kind == Light::Kind::directional;
    dvec3 to_light = directional ? -placed.direction : at - s.position;
    const double distance = glm::length(to_light);
    if (!(distance > 0)) return out;
    to_light /= distance;
    const double n_l = glm::dot(f.normal, to_light);
    const bool front = n_l > 0;
    if (n_l == 0 || (!front && m.diffuse_transmission == dvec3(0))) return out;
    dvec3 intensity = l.intensity;
    if (!directional) {
        // A spherical light attenuates with the distance to its centre, so its radius affects only shadows.
        const double r = l.kind == Light::Kind::sphere ? glm::length(placed.position - s.position) : distance;
        intensity /= l.attenuation.x + r * (l.attenuation.y + r * l.attenuation.z);
    }
    if (l.kind == Light::Kind::spot) {
        const double c = -glm::dot(to_light, placed.direction);
        if (c <= placed.cos_outer) return out;
        if (c < placed.cos_inner) {
            const double t = (c - placed.cos_outer) / (placed.cos_inner - placed.cos_outer);
            intensity *= t * t * (3 - 2 * t);
        }
    }
    dvec3 reflected = (front ? m.diffuse : m.diffuse_transmission) * colour * std::abs(n_l);
    if (front && m.has_highlight()) {
        // The highlight of the Phong model depends on the cosine R . V. R is the direction to the light,
        // mirrored at the surface normal, and V is the direction to the eye, i.e. -direction.
        const double r_v = -glm::dot(2 * n_l * f.normal - to_light, direction);
        if (r_v > 0) reflected += highlight(m, to_light, direction) * std::pow(r_v, m.shininess);
    }
    out.radiance = intensity * reflected;
    out.to_light = to_light;
    out.casts_shadow = l.casts_shadows;
    if (!l.casts_shadows || out.radiance == dvec3(0)) return out;
    // The shadow ray starts slightly off the surface, on the side that faces the light.
    const double side = glm::dot(f.geometric_normal, to_light) >= 0 ? 1 : -1;
    out.origin = s.position + (side * RayScene::offset(s.position)) * f.geometric_normal;
    // The shadow ray ends just before the light, so that a surface at the light's position blocks nothing.
    out.segment = directional ? to_light : at - out.origin;
    out.reach = directional ? std::numeric_limits<float>::infinity() : 1 - 1e-6F;
    return out;
}

Continuation continuation(const Material& m, const Facing& f, const dvec3& direction) {
    Continuation c;
    c.reflected = m.reflection;
    c.d_n = glm::dot(direction, f.normal);
    c.eta = f.entering() ? 1 / m.ior : m.ior;
    const double k = 1 - c.eta * c.eta * (1 - c.d_n * c.d_n);
    c.refracts = m.transmission != dvec3(0);
    if (c.refracts && k <= 0) {
        c.reflected += m.transmission;  // in total internal reflection, the transmitted part is reflected
        c.refracts = false;
    }
    if (c.refracts) {
        c.transmitted = m.transmission;
        c.root = std::sqrt(k);
    }
    if (m.fresnel && (k > 0 || m.transmission == dvec3(0))) {
        // Schlick's approximation needs the angle in the medium with the smaller index of refraction.
        // For a ray that leaves the denser medium, it is the angle of the refracted ray.
        const bool from_dense = c.eta > 1 && m.transmission != dvec3(0);
        const double weight = schlick_weight(from_dense ? std::sqrt(k) : -c.d_n);
        c.reflected = glm::mix(m.reflection, m.reflection_grazing, weight);
        if (c.refracts) c.transmitted = glm::mix(m.transmission, m.transmission_grazing, weight);
    }
    return c;
}

dvec3 mirrored_direction(const Continuation& c, const Facing& f, const dvec3& direction, bool& inwards) {
    dvec3 mirrored = direction - 2 * c.d_n * f.normal;
    inwards = glm::dot(mirrored, f.geometric_normal) <= 0;
    // The mirror direction was computed from the interpolated normal of the mesh, and it may therefore point
    // into the surface. In this case, it is computed again from the geometric normal, with which it never
    // does so.
    if (inwards) mirrored = glm::reflect(direction, f.geometric_normal);
    return glm::normalize(mirrored);
}

dvec3 refracted_direction(const Continuation& c, const Facing& f, const dvec3& direction) {
    return glm::normalize(c.eta * direction + (-c.eta * c.d_n - c.root) * f.normal);
}

bool lobe_is_wide(double exponent, double lens_radius_m, double distance_m) {
    return std::isfinite(exponent) && distance_m * distance_m > lens_radius_m * lens_radius_m * exponent;
}

bool has_deeper_nodes(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.reflects() || m.transmission != dvec3(0); });
}

}  // namespace postlens
