// Whitted's shading model [whitted1980], shared by everything that traces: what a surface sends towards a
// ray, light by light, and where its mirrored and refracted rays go.
#pragma once

#include <glm/glm.hpp>

#include "tracer/ray_scene.h"
#include "tracer/scene.h"

namespace postlens {

[[nodiscard]] double largest(const glm::dvec3& v);

/// The surface as the ray sees it: normals turned against the ray.
struct Facing {
    glm::dvec3 normal{0}, geometric_normal{0};
    double sign = 1;      ///< of the turn
    bool smooth = false;  ///< false: the facet's own normal stands in for the interpolated one
    [[nodiscard]] bool entering() const { return sign > 0; }
};
[[nodiscard]] Facing face(const SurfacePoint& s, const glm::dvec3& direction);

/// Light that the surface gives by itself: ambient and emission.
[[nodiscard]] glm::dvec3 own_radiance(const Scene& scene, const Material& m, const SurfacePoint& s,
                                      const glm::dvec3& colour);
/// What multiplies ambient and diffuse there.
[[nodiscard]] glm::dvec3 surface_colour(const Material& m, const SurfacePoint& s);

/// A light at an instant.
struct PlacedLight {
    const Light* light = nullptr;
    glm::dvec3 position{0}, direction{0}, edge_u{0}, edge_v{0};
    double cos_outer = 0, cos_inner = 0;
};
[[nodiscard]] PlacedLight place_light(const Light& light, double time_s);
/// By the matrix that its keys give at that instant.
[[nodiscard]] PlacedLight place_light(const Light& light, const glm::dmat4& motion);

/// The point of the light's extent that (u, v) in [0, 1)^2 picks as seen from `from`: of a sphere, evenly
/// over the solid angle that it covers; of a rectangle, evenly over its area; else the light's position.
[[nodiscard]] glm::dvec3 light_point(const PlacedLight& placed, const glm::dvec3& from, const glm::dvec2& uv);

/// What one light adds, were nothing in between.
struct Lit {
    glm::dvec3 radiance{0};  ///< 0: no light arrives
    glm::dvec3 to_light{0};  ///< unit
    bool casts_shadow = true;
    /// The shadow ray: origin + t * segment, t < reach.
    glm::dvec3 origin{0}, segment{0};
    float reach = 0;
};
/// `at`: light_point. `direction`: of the ray that sees the surface.
[[nodiscard]] Lit lit_by(const PlacedLight& placed, const glm::dvec3& at, const SurfacePoint& s,
                         const Facing& f, const Material& m, const glm::dvec3& colour,
                         const glm::dvec3& direction);

/// The weight of the grazing value in Schlick's approximation: (1 - cosine)^5 [schlick1994, eq. 24].
[[nodiscard]] double schlick_weight(double cosine);

/// Where mirrored and refracted rays go and what of their light arrives.
struct Continuation {
    glm::dvec3 reflected{0}, transmitted{0};  ///< shares; total internal reflection adds to `reflected`
    double d_n = 0, eta = 1, root = 0;  ///< direction . normal; index ratio; cosine of the refracted ray
    bool refracts = false;
};
[[nodiscard]] Continuation continuation(const Material& m, const Facing& f, const glm::dvec3& direction);
/// Unit directions. `inwards`: the interpolated normal would have sent the ray into the surface, and the
/// facet's own stood in.
[[nodiscard]] glm::dvec3 mirrored_direction(const Continuation& c, const Facing& f,
                                            const glm::dvec3& direction, bool& inwards);
[[nodiscard]] glm::dvec3 refracted_direction(const Continuation& c, const Facing& f,
                                             const glm::dvec3& direction);

/// Whether a lobe cos^exponent about a mirrored or refracted ray is wider than a lens of this radius as seen
/// from the surface, whose distance from the lens, m, is measured along the path. The width of a lobe is
/// 1 / sqrt(exponent), its standard deviation per axis for large exponents, rad. False for infinity.
[[nodiscard]] bool lobe_is_wide(double exponent, double lens_radius_m, double distance_m);

/// Whether some material reflects or transmits.
[[nodiscard]] bool has_deeper_nodes(const Scene& scene);

}  // namespace postlens
