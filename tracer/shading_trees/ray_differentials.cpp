#include "tracer/shading_trees/ray_differentials.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

using glm::dvec3;

// Solves the equation A W = B for the 2 x 2 matrix W by least squares. The columns of A are the vectors a0
// and a1, and those of B are b0 and b1. All four vectors lie in one plane, so the solution is exact.
Mat2 solve(const dvec3& a0, const dvec3& a1, const dvec3& b0, const dvec3& b1) {
    const double m00 = glm::dot(a0, a0), m01 = glm::dot(a0, a1), m11 = glm::dot(a1, a1);
    const double det = m00 * m11 - m01 * m01;
    // The matrix W describes how a point's image moves when the lens point moves. It is the solution of
    // linear equations with the determinant `det`. Where neighbouring rays converge in one point, `det` is 0
    // and W would be infinite. Then `inverse` is a huge number instead of 1 / det, and the entries of W are
    // limited to 1e30, which a float can store.
    const double inverse = det > 0 ? 1 / det : 1e300;
    const auto clamped = [](double v) {
        return static_cast<float>(std::isfinite(v) ? std::clamp(v, -1e30, 1e30) : 1e30);
    };
    const double r00 = glm::dot(a0, b0), r10 = glm::dot(a1, b0), r01 = glm::dot(a0, b1),
                 r11 = glm::dot(a1, b1);
    return {clamped((m11 * r00 - m01 * r10) * inverse), clamped((m11 * r01 - m01 * r11) * inverse),
            clamped((m00 * r10 - m01 * r00) * inverse), clamped((m00 * r11 - m01 * r01) * inverse)};
}

}  // namespace

RayDifferentials eye_differentials(const CameraModel& camera, const CameraRay& ray) {
    RayDifferentials out;
    // The tangent (p_x, p_y) of an eye ray holds its slopes along the raster's axes. So the ray's direction
    // is D = v / |v|, where v = forward + p_x right + p_y down. If p_x or p_y changes, v changes by dv, which
    // is `right` or `down`. `across` returns the resulting derivative of D, which is (dv - D (D . dv)) / |v|.
    // Here, 1 / |v| is `cos_axis`, the cosine of the ray's angle to the optical axis.
    const auto across = [&](const dvec3& dv) {
        return (dv - ray.direction * glm::dot(ray.direction, dv)) * ray.cos_axis;
    };
    out.direction[0] = across(camera.right);
    out.direction[1] = across(camera.down);
    out.point[2] = camera.right;
    out.point[3] = camera.down;
    return out;
}

void transfer(RayDifferentials& differentials, const dvec3& direction, double t, const dvec3& normal) {
    const double inverse = 1 / glm::dot(direction, normal);
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec3 moved = differentials.point[i] + t * differentials.direction[i];
        differentials.point[i] = moved - direction * (glm::dot(moved, normal) * inverse);
    }
}

RayDifferentials reflect(const RayDifferentials& differentials, const dvec3& direction, const dvec3& normal,
                         const glm::dmat3& shape_operator) {
    RayDifferentials out;
    out.point = differentials.point;
    const double dn = glm::dot(direction, normal);
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec3 dd = differentials.direction[i];
        const dvec3 d_normal = shape_operator * differentials.point[i];
        const double d_dn = glm::dot(dd, normal) + glm::dot(direction, d_normal);
        out.direction[i] = dd - 2.0 * (d_dn * normal + dn * d_normal);
    }
    return out;
}

RayDifferentials refract(const RayDifferentials& differentials, const dvec3& direction, const dvec3& normal,
                         const glm::dmat3& shape_operator, double eta) {
    RayDifferentials out;
    out.point = differentials.point;
    // Computes the derivatives of the refracted direction D' = eta D + mu N from those of the ray. D is
    // `direction`, N is `normal`, and eta is the ratio of the refractive indices. c = -D . N is the cosine of
    // the angle of incidence, k = 1 - eta^2 (1 - c^2) is the squared cosine of the angle of refraction, and
    // mu = eta c - sqrt(k).
    const double c = -glm::dot(direction, normal);
    const double root = std::sqrt(1 - eta * eta * (1 - c * c));
    const double mu = eta * c - root;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec3 dd = differentials.direction[i];
        const dvec3 d_normal = shape_operator * differentials.point[i];
        const double dc = -(glm::dot(dd, normal) + glm::dot(direction, d_normal));
        const double d_mu = eta * dc - eta * eta * c * dc / root;
        out.direction[i] = eta * dd + d_mu * normal + mu * d_normal;
    }
    return out;
}

Mat2 refocus_matrix(const RayDifferentials& d) {
    return solve(d.point[0], d.point[1], d.point[2], d.point[3]);
}

Mat2 refocus_matrix_at_infinity(const RayDifferentials& d) {
    return solve(d.direction[0], d.direction[1], d.direction[2], d.direction[3]);
}

}  // namespace postlens
