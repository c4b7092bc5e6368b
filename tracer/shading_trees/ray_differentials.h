// Ray differentials through mirrors and glass [igehy1999]: derivatives of a ray by the tangent p of its
// direction at the pinhole and by its lens point q. They determine the matrix W of a node, which says how the
// image of the node moves when the lens point moves.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Derivatives of a ray's point and unit direction by (p_x, p_y, q_x, q_y). p is the tangent of the eye ray
/// and q the lens point in m, both along the raster's axes (x right, y down).
struct RayDifferentials {
    std::array<glm::dvec3, 4> point{};
    std::array<glm::dvec3, 4> direction{};
};

/// The differentials of an eye ray of a perspective camera, at its origin.
[[nodiscard]] RayDifferentials eye_differentials(const CameraModel& camera, const CameraRay& ray);

/// Transfers differentials along the ray by `t`, onto the plane through the hit with normal `normal`.
void transfer(RayDifferentials& differentials, const glm::dvec3& direction, double t,
              const glm::dvec3& normal);

/// The differentials after reflection at a surface with unit normal `normal`, whose derivative by position is
/// `shape_operator`, 1/m.
[[nodiscard]] RayDifferentials reflect(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator);

/// The differentials after refraction. `eta` = index before / index behind the surface; `normal` points
/// against the ray. Not for total internal reflection.
[[nodiscard]] RayDifferentials refract(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator,
                                       double eta);

/// The matrix W = (dX/dp)^-1 dX/dq of the ray's point X, 1/m, along the raster's axes. At a fold, where dX/dp
/// has no inverse, the entries are huge but finite.
[[nodiscard]] Mat2 refocus_matrix(const RayDifferentials& differentials);

/// The matrix W of a ray that leaves the scene. X is then the direction of the ray instead of a point.
[[nodiscard]] Mat2 refocus_matrix_at_infinity(const RayDifferentials& differentials);

}  // namespace postlens
