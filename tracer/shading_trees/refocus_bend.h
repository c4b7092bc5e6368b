// Measures how nonlinearly images in mirrors and glass move when the lens point moves. The sample file stores
// a linear prediction of this motion. Additional rays from several lens points measure the error of the
// prediction, which is stored as `w_bend`.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/shading_trees/ray_differentials.h"

namespace postlens {

/// The mirrors and glass objects at which a path has reflected or refracted so far.
struct Bounces {
    std::array<std::uint32_t, NodePath::max_bounces> object{};  ///< index into Scene::objects, per bounce
    bool flat = true;  ///< all bounces are reflections at flat surfaces, for which W is exact
};

/// A surface hit that is seen in a mirror or through glass. When the lens point moves by q, m, from the lens
/// centre, the image of this hit moves almost linearly. `w_bend` is the error of the linear prediction of
/// this motion, divided by |q|^2, in 1/m^2. It is measured by exact rays: for several lens points, the ray is
/// found that bounces at the same objects and reaches the same point, `target`.
struct BentNode {
    std::uint32_t node = 0;  ///< index for the caller's use
    NodePath path;
    Bounces bounces;
    int hidden_bounce = -1;    ///< bounce that may lie behind other surfaces; -1 if none
    bool at_infinity = false;  ///< `target` is a direction, not a point
    glm::dvec3 target{0};      ///< end of the path, world
    glm::dvec3 direction{0};   ///< direction of the path's last ray, unit length
    glm::dvec2 tangent{0};     ///< tangent of the eye ray, along the raster's axes
    /// How the world position, m, of the surface hit changes with the eye ray that leads to it: the
    /// derivatives with respect to the two components of `tangent`. These are the eye ray's slopes x / z and
    /// y / z, where z is along the optical axis.
    std::array<glm::dvec3, 2> by_tangent{};
    Mat2 w;
};

/// Computes `w_bend` of each node, 1/m^2: the second-order motion of its image when the lens point moves.
/// It is the largest |e| / |q|^2 over several lens points q. The error e is the tangent of the exact ray
/// from q to the target minus its prediction p - W q, where p is the tangent of the eye ray.
///
/// There are four lens points, at `radius_m` on the raster axes. The first two are at right angles.
/// If both have an error below 0.05 px, the other two are not used.
/// Newton's method finds the ray from a lens point that bounces at the same objects and reaches the target.
/// If it has not converged after five steps, the remaining error is estimated and added.
/// Occlusion between the last bounce and the target is ignored.
///
/// A lens point is skipped if its ray hits another object or nothing before the last bounce.
/// The result is infinite:
/// - if all lens points are skipped
/// - if the search does not converge
/// - if it ends in total internal reflection
///
/// The results are rounded to half precision. Adds the number of traced rays to `rays_spent`.
/// Thread-safe and deterministic.
void measure_bends(const RayScene& scene, const CameraModel& camera, double radius_m,
                   std::span<const BentNode> nodes, std::vector<float>& out, std::uint64_t& rays_spent);

}  // namespace postlens
