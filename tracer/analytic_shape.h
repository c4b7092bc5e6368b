// Shapes with a formula, each in a canonical frame of its own, so that one affine map does the rest.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "tracer/scene.h"

namespace postlens {

/// Shape in its canonical ("local") frame:
/// sphere: unit sphere. box: [0, 1]^3. disc: unit disc in z = 0 without the disc of radius `inner`.
/// rectangle: [0, 1]^2 in z = 0. plane: z = 0. cone: axis z from 0 to `height`, radius from `radius0` to
/// `radius1`.
struct AnalyticShape {
    enum class Kind { sphere, box, disc, rectangle, plane, cone };
    Kind kind = Kind::sphere;
    double inner = 0;
    double height = 1, radius0 = 1, radius1 = 1;
    bool capped = false;
    /// In the plane z = 0.
    [[nodiscard]] bool flat() const {
        return kind == Kind::disc || kind == Kind::rectangle || kind == Kind::plane;
    }
};

/// The canonical shape and where it lies in object space. Empty for a mesh.
struct PlacedShape {
    AnalyticShape shape;
    glm::dmat4 object_from_local{1};
};
[[nodiscard]] std::optional<PlacedShape> place_shape(const Shape& shape);

/// Where a line o + t d meets the shape: every crossing, unsorted; `part` tells faces and caps apart.
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
/// Parts of a cone; a box has parts 0..5: 2 * axis + (upper face).
inline constexpr int part_lateral = 0, part_base = 1, part_apex = 2;

template <typename T>
[[nodiscard]] Crossings<T> crossings(const AnalyticShape& shape, const glm::vec<3, T>& o,
                                     const glm::vec<3, T>& d);

/// Differential geometry at a point of the shape, local frame.
struct LocalGeometry {
    glm::dvec3 normal{0, 0, 1};    ///< unit, outward
    glm::dmat3 shape_operator{0};  ///< dN = shape_operator * dP for moves within the surface, 1/length
};
[[nodiscard]] LocalGeometry local_geometry(const AnalyticShape& shape, int part, const glm::dvec3& p);
/// Surface coordinates there.
[[nodiscard]] glm::dvec2 local_uv(const AnalyticShape& shape, int part, const glm::dvec3& p);

}  // namespace postlens
