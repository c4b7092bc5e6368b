// Ray differentials through mirrors and glass [igehy1999]: how a ray moves when its tangent p at the pinhole
// or its origin q on the lens moves. From them W, the depth at which a node of the shading tree refocuses.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// Derivatives of a ray's point and unit direction by (p_x, p_y, q_x, q_y): p the tangent of the eye ray, q
/// the lens point in m, both in raster axes (x right, y down).
struct RayDifferentials {
    std::array<glm::dvec3, 4> point{};
    std::array<glm::dvec3, 4> direction{};
};

/// Of an eye ray of a perspective camera, at its origin.
[[nodiscard]] RayDifferentials eye_differentials(const CameraModel& camera, const CameraRay& ray);

/// Carried along the ray by `t` onto the plane with `normal` through the hit.
void transfer(RayDifferentials& differentials, const glm::dvec3& direction, double t,
              const glm::dvec3& normal);

/// Mirrored at a surface whose unit normal is `normal` and changes by `shape_operator` per metre.
[[nodiscard]] RayDifferentials reflect(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator);

/// Refracted: `eta` = index before / index behind, `normal` against the ray. Not for total internal
/// reflection.
[[nodiscard]] RayDifferentials refract(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator,
                                       double eta);

/// W = (dX/dp)^-1 dX/dq of the point the differentials describe, 1/m, raster axes. At a fold, where dX/dp has
/// no inverse, a matrix of huge finite entries.
[[nodiscard]] Mat2 refocus_matrix(const RayDifferentials& differentials);

/// The same for a ray that leaves the scene: its direction is held instead of its hit point.
[[nodiscard]] Mat2 refocus_matrix_at_infinity(const RayDifferentials& differentials);

}  // namespace postlens
