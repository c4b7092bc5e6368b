// Translation, rotation and scale of nodes in scene files.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace postlens {

/// Maps a point p to translation + rotation (scale p).
struct Placement {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
};

[[nodiscard]] glm::dmat4 matrix_of(const Placement& p);

/// A placement (translation, rotation, scale) that approximates a matrix, exactly if it has no shear.
/// The rotation is the orthogonal factor of the polar decomposition [higham1986].
/// A mirroring matrix gives a negative scale along x, and a singular matrix a scale of 0.
struct Decomposed {
    Placement placement;
    /// Error of `placement` as an approximation of the decomposed matrix. A Placement consists of
    /// translation, rotation and scale, so it cannot represent shear. The error is the largest distance
    /// between corresponding columns of the matrix of `placement` and the decomposed matrix, divided by the
    /// length of the longest column.
    double error = 0;
};
[[nodiscard]] Decomposed decompose(const glm::dmat4& m);

/// Returns the product matrix_of(outer) * matrix_of(inner) as a placement.
/// It is exact if the outer scale is uniform or the inner rotation is the identity.
/// Otherwise the product may contain shear, and `decompose` approximates it.
[[nodiscard]] Decomposed compose(const Placement& outer, const Placement& inner);

}  // namespace postlens
