// Shapes that are defined by a formula, such as a unit sphere.
// An affine map transforms each from its own frame to object space.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "scene/scene.h"

namespace postlens {

/// A shape in its canonical ("local") frame:
/// - sphere: the unit sphere
/// - box: [0, 1]^3
/// - disc: the unit disc in z = 0, with a hole of radius `inner`
/// - rectangle: [0, 1]^2 in z = 0
/// - plane: z = 0
/// - cone: around the z axis, from z = 0 to `height`, with a radius from `radius0` to `radius1`
struct AnalyticShape {
    enum class Kind { sphere, box, disc, rectangle, plane, cone };
    Kind kind = Kind::sphere;
    double inner = 0;
    double height = 1, radius0 = 1, radius1 = 1;
    bool capped = false;
    /// True if the shape lies in the plane z = 0.
    [[nodiscard]] bool flat() const {
        return kind == Kind::disc || kind == Kind::rectangle || kind == Kind::plane;
    }
};

/// A shape in its canonical frame, and the affine map from this frame to object space.
struct PlacedShape {
    AnalyticShape shape;
    glm::dmat4 object_from_local{1};
};
/// Empty for a mesh.
[[nodiscard]] std::optional<PlacedShape> place_shape(const Shape& shape);

/// The points where a line o + t d crosses a shape. Each crossing is given by its parameter t. The crossings
/// are not sorted. `part` tells on which part of the shape each of them lies, such as a face of a box or a
/// cap of a cone.
template <typename T>
struct Crossings {
    int count = 0;
    T t[6] = {};
    int part[6] = {};
    void add(T at, int on) {
        t[count] = at;
        part[count++] = on;
    }
};
/// Numbers of a cone's parts: lateral surface, cap at the base, cap at the apex.
/// A box's faces have the numbers 2 * axis (lower side) and 2 * axis + 1 (upper side).
inline constexpr int part_lateral = 0, part_base = 1, part_apex = 2;

template <typename T>
[[nodiscard]] Crossings<T> crossings(const AnalyticShape& shape, const glm::vec<3, T>& o,
                                     const glm::vec<3, T>& d);

/// Returns the outward unit normal at point `p` of the shape's face or cap `part`, in the shape's own frame.
[[nodiscard]] glm::dvec3 local_normal(const AnalyticShape& shape, int part, const glm::dvec3& p);
/// Returns the matrix S, 1/length, with dN = S dP: how the unit normal N changes for a step dP on the
/// surface.
[[nodiscard]] glm::dmat3 local_shape_operator(const AnalyticShape& shape, int part, const glm::dvec3& p);
/// Returns the texture coordinates (u, v) of point `p` of the shape, which is given in the shape's own frame.
[[nodiscard]] glm::dvec2 local_uv(const AnalyticShape& shape, int part, const glm::dvec3& p);

}  // namespace postlens
