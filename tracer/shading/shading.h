// Whitted's shading model [whitted1980]: the radiance of a surface along a ray, light by light,
// and the directions and weights of reflected and refracted rays.
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

[[nodiscard]] double largest(const glm::dvec3& v);

/// The shading normal and the geometric normal of a surface, turned to the side from which the ray comes.
struct Facing {
    glm::dvec3 normal{0}, geometric_normal{0};
    double sign = 1;      ///< -1 if the normals were reversed
    bool smooth = false;  ///< false if the geometric normal replaces the interpolated one
    [[nodiscard]] bool entering() const { return sign > 0; }
};
[[nodiscard]] Facing face(const SurfacePoint& s, const glm::dvec3& direction);

/// Returns the radiance that a surface has even if no light source illuminates it: the light that it emits
/// itself, and the ambient term. `colour` is its surface_colour().
[[nodiscard]] glm::dvec3 own_radiance(const Scene& scene, const Material& m, const SurfacePoint& s,
                                      const glm::dvec3& colour);
/// Returns the surface colour at a hit, by which the ambient and diffuse terms are multiplied.
[[nodiscard]] glm::dvec3 surface_colour(const Material& m, const SurfacePoint& s);

/// A light source at one instant.
struct PlacedLight {
    const Light* light = nullptr;
    glm::dvec3 position{0}, direction{0}, edge_u{0}, edge_v{0};
    double cos_outer = 0, cos_inner = 0;
};
[[nodiscard]] PlacedLight place_light(const Light& light, double time_s);
/// Returns where a light is at one instant. `motion` is the matrix that its keyframes give for this instant.
[[nodiscard]] PlacedLight place_light(const Light& light, const glm::dmat4& motion);

/// Returns the point on a light source for random numbers (u, v) in [0, 1)^2, as seen from the point `from`.
/// Spheres are sampled uniformly in solid angle, and rectangles uniformly in area.
/// For any other light, returns its position.
[[nodiscard]] glm::dvec3 light_point(const PlacedLight& placed, const glm::dvec3& from, const glm::dvec2& uv);

/// Contribution of one light without occlusion.
struct Lit {
    glm::dvec3 radiance{0};  ///< 0: no light arrives
    glm::dvec3 to_light{0};  ///< direction to the light, unit length
    bool casts_shadow = true;
    /// The shadow ray is origin + t * segment for t < reach.
    glm::dvec3 origin{0}, segment{0};
    float reach = 0;
};
/// Returns the radiance that a surface reflects or transmits from one light towards the eye, if no shadow
/// falls on it. `at` is a point on the light (light_point). `direction` is the direction of the ray that sees
/// the surface.
[[nodiscard]] Lit lit_by(const PlacedLight& placed, const glm::dvec3& at, const SurfacePoint& s,
                         const Facing& f, const Material& m, const glm::dvec3& colour,
                         const glm::dvec3& direction);

/// Returns (1 - cosine)^5, the weight of the reflectance at grazing incidence [schlick1994, eq. 24].
[[nodiscard]] double schlick_weight(double cosine);

/// How light paths continue at a surface hit: the weights of the reflected and the refracted ray, and the
/// values from which the directions of both rays are computed.
struct Continuation {
    /// Factors by which the radiance of the reflected and the refracted ray is multiplied.
    /// In total internal reflection, `transmitted` is 0 and its light is added to `reflected`.
    glm::dvec3 reflected{0}, transmitted{0};
    double d_n = 0, eta = 1, root = 0;  ///< direction . normal; ratio of indices; cosine of the refracted ray
    bool refracts = false;
};
[[nodiscard]] Continuation continuation(const Material& m, const Facing& f, const glm::dvec3& direction);
/// Returns the unit direction of the reflected ray. If the interpolated normal would reflect it into the
/// surface, the geometric normal is used and `inwards` is set.
[[nodiscard]] glm::dvec3 mirrored_direction(const Continuation& c, const Facing& f,
                                            const glm::dvec3& direction, bool& inwards);
[[nodiscard]] glm::dvec3 refracted_direction(const Continuation& c, const Facing& f,
                                             const glm::dvec3& direction);

/// True if a glossy lobe, cos^exponent, is wider than the lens, as seen from the surface.
/// The lobe's width is 1 / sqrt(exponent), rad. `distance_m` is the path length to the lens.
[[nodiscard]] bool lobe_is_wide(double exponent, double lens_radius_m, double distance_m);

/// True if a material reflects or transmits.
[[nodiscard]] bool has_deeper_nodes(const Scene& scene);

}  // namespace postlens
