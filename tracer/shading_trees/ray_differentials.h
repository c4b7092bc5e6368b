// Ray differentials through mirrors and glass [igehy1999]: derivatives of a ray with respect to
// the eye ray's direction and the lens point. They give W, the motion of a node's image with the lens point.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "records/record.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Derivatives of a ray's point and unit direction with respect to (p_x, p_y, q_x, q_y).
/// - p: tangent of the eye ray
/// - q: lens point, m
/// Both are along the raster's axes (x right, y down).
struct RayDifferentials {
    std::array<glm::dvec3, 4> point{};
    std::array<glm::dvec3, 4> direction{};
};

/// Returns the differentials of an eye ray of a perspective camera, at the origin of the ray.
[[nodiscard]] RayDifferentials eye_differentials(const CameraModel& camera, const CameraRay& ray);

/// Moves the differentials along the ray by `t`, to a hit whose surface has the normal `normal`.
void transfer(RayDifferentials& differentials, const glm::dvec3& direction, double t,
              const glm::dvec3& normal);

/// Returns the differentials after reflection at a surface with the unit normal `normal`.
/// `shape_operator` is the derivative of the normal with respect to the position, 1/m.
[[nodiscard]] RayDifferentials reflect(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator);

/// Returns the differentials after refraction. Not for total internal reflection.
/// `eta` is the ratio of the refractive indices in front of and behind the surface.
/// `normal` points against the ray.
[[nodiscard]] RayDifferentials refract(const RayDifferentials& differentials, const glm::dvec3& direction,
                                       const glm::dvec3& normal, const glm::dmat3& shape_operator,
                                       double eta);

/// Returns the matrix W = (dX/dp)^-1 dX/dq, 1/m, along the raster's axes.
/// - X: point that the ray hits
/// - p: tangent of the eye ray
/// - q: lens point
///
/// Where neighbouring eye rays converge in one point, the entries of W are huge but finite.
[[nodiscard]] Mat2 refocus_matrix(const RayDifferentials& differentials);

/// Returns the matrix W of a ray that hits nothing, from the derivatives of its direction.
[[nodiscard]] Mat2 refocus_matrix_at_infinity(const RayDifferentials& differentials);

}  // namespace postlens
