// How far W errs: what mirrors and glass show moves with the lens point q by -W q only to first order. The
// second order is measured against exact rays from the rim of a lens.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/ray_differentials.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// Where a chain of rays was bounced so far.
struct Bounces {
    std::array<std::uint32_t, NodePath::max_bounces> object{};  ///< index into Scene::objects, per bounce
    bool flat = true;  ///< all are reflections at flat surfaces: W is exact
};

/// A node behind a bounce, and what a ray from another point of the lens must meet to see the same.
struct BentNode {
    std::uint32_t node = 0;  ///< for the caller
    NodePath path;
    Bounces bounces;
    int hidden_bounce = -1;    ///< the bounce that may be met behind other surfaces; -1: none
    bool at_infinity = false;  ///< `target` is a direction, not a point
    glm::dvec3 target{0};      ///< where the chain ends, world
    glm::dvec3 direction{0};   ///< the chain's last, of unit length
    glm::dvec2 tangent{0};     ///< of the eye ray, raster axes
    /// Of the target by the tangent of the eye ray, world.
    std::array<glm::dvec3, 2> by_tangent{};
    Mat2 w;
};

/// W.bend of each node, 1/m^2: the largest departure of the tangent of the ray that sees the target from
/// p - W q, over |q|^2, among four lens points q at `radius_m` on the raster axes; two of them, at right
/// angles, where it is under 0.05 px for both. The rays are followed through the same chain of objects up to
/// the last bounce and found by Newton's method with the derivatives at the pinhole; what five steps leave
/// unsettled is added. Infinity where that does not converge or a chain ends by total reflection. Rays that
/// something else stands in the way of, or that pass beyond an outline, do not count, unless all four do:
/// then it is infinity as well. Nor does what stands between the last bounce and the target. Rounded to what
/// a half float holds. Adds the rays traced to `rays_spent`. Thread-safe; deterministic.
void measure_bends(const RayScene& scene, const CameraModel& camera, double radius_m,
                   std::span<const BentNode> nodes, std::vector<float>& out, std::uint64_t& rays_spent);

}  // namespace postlens
