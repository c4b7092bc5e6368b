#include "scene/placement.h"

#include <algorithm>
#include <cmath>

namespace postlens {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;

namespace {

// A column of `m` whose length is almost 0, compared with the length of the longest column, has no reliable
// direction. Replaces it by a unit vector perpendicular to the other columns.
void mend_columns(dmat3& m, const dvec3& length, double longest) {
    for (int i = 0; i < 3; ++i) {
        if (length[i] > 1e-12 * longest) continue;
        const dvec3 a = m[(i + 1) % 3], b = m[(i + 2) % 3];
        dvec3 across = glm::cross(a, b);
        if (!(glm::length(across) > 0)) {
            const dvec3 along = glm::length(a) > 0 ? a : b;
            across = glm::cross(
                along, std::abs(along.x) < 0.6 * glm::length(along) ? dvec3(1, 0, 0) : dvec3(0, 1, 0));
        }
        m[i] = glm::normalize(across);
    }
}

}  // namespace

dmat4 matrix_of(const Placement& p) {
    dmat4 m = glm::mat4_cast(p.rotation);
    for (int axis = 0; axis < 3; ++axis) m[axis] *= p.scale[axis];
    m[3] = glm::dvec4(p.translation, 1);
    return m;
}

Decomposed decompose(const dmat4& m) {
    Decomposed out;
    out.placement.translation = dvec3(m[3]);
    const dmat3 linear(m);
    const dvec3 length(glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2]));
    const double longest = std::max({length.x, length.y, length.z});
    if (!(longest > 0)) {
        out.placement.scale = dvec3(0);
        return out;
    }
    // The rotation is computed from `linear` by polar decomposition, an iteration that makes the columns of a
    // matrix perpendicular. It starts with the columns of `linear` scaled to unit length. Their lengths are
    // left out, because they belong to the placement's scale, not to its rotation.
    dmat3 r = linear;
    for (int i = 0; i < 3; ++i) {
        if (length[i] > 0) r[i] /= length[i];
    }
    mend_columns(r, length, longest);
    const bool mirrors = glm::determinant(r) < 0;
    if (mirrors) r[0] = -r[0];
    for (int step = 0; step < 50; ++step) {
        const dmat3 next = 0.5 * (r + glm::transpose(glm::inverse(r)));
        double change = 0;
        for (int i = 0; i < 3; ++i) change = std::max(change, glm::length(next[i] - r[i]));
        if (!std::isfinite(change)) break;  // the columns lie in a plane; r is the best result so far
        r = next;
        if (change < 1e-15) break;
    }
    for (int i = 0; i < 3; ++i) out.placement.scale[i] = glm::dot(r[i], linear[i]);
    out.placement.rotation = glm::normalize(glm::quat_cast(r));
    const dmat4 back = matrix_of(out.placement);
    for (int i = 0; i < 3; ++i) {
        out.error = std::max(out.error, glm::length(dvec3(back[i]) - linear[i]) / longest);
    }
    return out;
}

Decomposed compose(const Placement& outer, const Placement& inner) {
    const bool even = outer.scale.x == outer.scale.y && outer.scale.y == outer.scale.z;
    const bool straight = inner.rotation.x == 0 && inner.rotation.y == 0 && inner.rotation.z == 0;
    if (!even && !straight) return decompose(matrix_of(outer) * matrix_of(inner));
    Decomposed out;
    out.placement.translation = outer.translation + outer.rotation * (outer.scale * inner.translation);
    out.placement.rotation = glm::normalize(outer.rotation * inner.rotation);
    out.placement.scale = outer.scale * inner.scale;
    return out;
}

}  // namespace postlens
