// Translation, rotation and scale: what nodes of scene files are placed by.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace postlens {

/// A point p goes to translation + rotation (scale p).
struct Placement {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
};

[[nodiscard]] glm::dmat4 matrix_of(const Placement& p);

/// The placement that a matrix stands for, and how far from it the matrix is: the largest distance between
/// the images of a unit axis, as a share of the longest. It is above rounding where the matrix shears. The
/// rotation is the orthogonal factor of the polar decomposition [higham1986]; a matrix that mirrors has a
/// negative scale along x, one that flattens a scale of 0.
struct Decomposed {
    Placement placement;
    double error = 0;
};
[[nodiscard]] Decomposed decompose(const glm::dmat4& m);

/// `inner` seen through `outer`: matrix_of(outer) * matrix_of(inner). Exact where the outer scale is the same
/// along all axes or the inner rotation is none; else, as scaling then shears, by `decompose`.
[[nodiscard]] Decomposed compose(const Placement& outer, const Placement& inner);

}  // namespace postlens
