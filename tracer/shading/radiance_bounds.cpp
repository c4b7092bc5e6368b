#include "tracer/shading/radiance_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "scene/shape_bounds.h"
#include "tracer/shading/shading.h"

namespace postlens {
namespace {

using glm::dmat4;
using glm::dvec3;

double distance_to(const Bounds& b, const dvec3& p) {
    return b.empty() ? std::numeric_limits<double>::infinity() : glm::length(p - glm::clamp(p, b.min, b.max));
}

double distance_to_segment(const dvec3& a, const dvec3& b, const dvec3& p) {
    const dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0;
    return glm::length(p - a - share * along);
}

// Returns a lower bound of the distance, m, between the point p and the object `o`, which moves, over all
// instants. The surface of the object stays within a ball around the object's origin. The origin moves on a
// straight line between two keyframes. So the bound is the distance of p to these lines, minus the ball's
// radius.
double distance_to_moving(const Object& o, const dvec3& p) {
    const Bounds rest = shape_bounds(o.shape, o.motion_base);
    const double reach = glm::length(glm::max(glm::abs(rest.min), glm::abs(rest.max)));
    double path = glm::length(p - o.keys[0].translation), scale = 0;
    for (std::size_t k = 0; k < o.keys.size(); ++k) {
        scale = std::max(scale, largest(glm::abs(o.keys[k].scale)));
        if (k > 0)
            path = std::min(path, distance_to_segment(o.keys[k - 1].translation, o.keys[k].translation, p));
    }
    return rest.empty() ? std::numeric_limits<double>::infinity() : std::max(0.0, path - scale * reach);
}

// Returns a lower bound of the distance from p to the surface of an object, m.
double distance_to(const Object& o, const dvec3& p) {
    if (!o.keys.empty()) return distance_to_moving(o, p);
    const dmat4& m = o.world_from_object;
    if (const auto* plane = std::get_if<Plane>(&o.shape)) {
        const dvec3 normal = glm::normalize(glm::inverse(glm::transpose(glm::dmat3(m))) * plane->normal);
        return std::abs(glm::dot(normal, p - dvec3(m * glm::dvec4(plane->point, 1))));
    }
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape);
    if (mesh == nullptr) return distance_to(shape_bounds(o.shape, m), p);
    double least = std::numeric_limits<double>::infinity();
    for (const glm::uvec3& t : (*mesh)->triangles) {
        Bounds b;
        for (int i = 0; i < 3; ++i) b.add(dvec3(m * glm::dvec4(dvec3((*mesh)->positions[t[i]]), 1)));
        least = std::min(least, distance_to(b, p));
    }
    return least;
}

// Returns an upper bound of the light that any surface receives from the light source `l`. If its light
// decreases with the distance, the bound is the light at `distance`. This variable is at most the distance,
// m, of the nearest surface. It remains 0 if the light source moves, or if the light is limited even at
// distance 0.
dvec3 greatest_irradiance(const Scene& scene, const Light& l) {
    if (l.kind == Light::Kind::directional) return l.intensity;
    double distance = 0;
    if (l.attenuation.x <= 0 && l.keys.empty()) {
        distance = std::numeric_limits<double>::infinity();
        for (const Object& o : scene.objects) distance = std::min(distance, distance_to(o, l.position));
        if (l.kind == Light::Kind::rectangle) distance -= (glm::length(l.edge_u) + glm::length(l.edge_v)) / 2;
        distance = std::max(0.0, distance);
    }
    const double attenuation =
        l.attenuation.x + (distance > 0 ? distance * (l.attenuation.y + distance * l.attenuation.z) : 0);
    constexpr double unbounded = 1e100;  // finite, so that its product with 0 is 0
    return attenuation > 0 ? l.intensity / attenuation : l.intensity * unbounded;
}

}  // namespace

std::vector<double> radiance_bounds(const Scene& scene, int max_depth) {
    dvec3 lit(0);
    for (const Light& l : scene.lights) lit += greatest_irradiance(scene, l);
    double local = largest(scene.background), passed_on = 0;
    for (const Material& m : scene.materials) {
        const double colour = m.colour_texture ? m.colour_texture->maximum() : 1;
        const dvec3 specular = m.fresnel ? glm::max(m.specular, m.specular_grazing) : m.specular;
        const double glow =
            (m.emission_texture ? m.emission_texture->maximum() : 1) * (m.emission_has_colour ? colour : 1);
        local = std::max(local, largest(m.emission * glow + m.ambient * colour * scene.ambient_light +
                                        lit * (colour * (m.diffuse + m.diffuse_transmission) + specular)));
        passed_on = std::max(passed_on, largest(m.reflection + m.transmission));
        if (m.fresnel)
            passed_on = std::max(passed_on, largest(m.reflection_grazing + m.transmission_grazing));
    }
    std::vector<double> bound(static_cast<std::size_t>(max_depth) + 1, 0);
    for (std::size_t k = 1; k < bound.size(); ++k) bound[k] = local + passed_on * bound[k - 1];
    return bound;
}

}  // namespace postlens
