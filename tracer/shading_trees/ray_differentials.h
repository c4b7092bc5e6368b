// Ray differentials [igehy1999] through mirrors and glass: how a ray changes with image position and lens
// point.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Tells how a ray changes when the eye ray from which it arose changes. Four numbers describe the eye ray,
/// along the raster's axes (x right, y down):
/// - p_x, p_y: its tangent, i.e. its direction divided by its component along the optical axis
/// - q_x, q_y: the lens point at which it starts, m
///
/// The arrays hold the derivatives with respect to p_x, p_y, q_x and q_y, in this order: `point` those of a
/// point on the ray, and `direction` those of its unit direction.
struct RayDifferentials {
    std::array<glm::dvec3, 4> point{};
    std::array<glm::dvec3, 4> direction{};
};

/// Returns how an eye ray of a perspective camera changes: the derivatives of its origin and of its unit
/// direction. They are taken with respect to its tangent (its direction divided by its component along the
/// optical axis) and to its lens point, m.
[[nodiscard]] RayDifferentials eye_differentials(const CameraModel& camera, const CameraRay& ray);

/// Moves ray differentials along the ray by the distance `t`, to a hit on a surface with the normal `normal`.
void transfer(RayDifferentials& differentials, const glm::dvec3& direction, double t,
              const glm::dvec3& normal);

/// Returns ray differentials after reflection at a surface with the unit normal `normal`.
/// `shape_operator` is the derivative of the normal with respect to the position, 1/m.
[[nodiscard]] RayDifferentials reflect(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator);

/// Returns ray differentials after refraction. Must not be called for total internal reflection.
/// `eta` is the refractive index on the ray's side of the surface divided by that on the other side.
/// `normal` points against the ray.
[[nodiscard]] RayDifferentials refract(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator,
                                       double eta);

/// Returns the matrix W, 1/m, of the point that a ray hits. If the lens point moves by q, the eye ray to this
/// point changes its tangent by -W q, to first order.
/// W = (dX/dp)^-1 dX/dq, along the raster's axes:
/// - X: point that the ray hits
/// - p: tangent of the eye ray, i.e. its direction divided by its component along the optical axis
/// - q: lens point, m
///
/// Where neighbouring eye rays converge in one point, dX/dp has almost no inverse. The entries of W are then
/// huge but finite.
[[nodiscard]] Mat2 refocus_matrix(const RayDifferentials& differentials);

/// Returns the matrix W, 1/m, of a ray that hits nothing, i.e. sees the background. W tells how the
/// background's image moves: if the lens point moves by q, in m, from the lens centre, the tangent of the ray
/// to the same background direction changes by -W q. The tangent consists of the slopes x / z and y / z.
[[nodiscard]] Mat2 refocus_matrix_at_infinity(const RayDifferentials& differentials);

}  // namespace postlens
