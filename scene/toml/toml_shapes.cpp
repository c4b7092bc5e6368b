#include "scene/toml/toml_shapes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>

#include "records/motion/toml_transform.h"
#include "scene/triangulate.h"

namespace postlens {
namespace {

using glm::dvec3;
using Name = std::string_view;

constexpr std::array<Name, 2> sphere_keys{"centre_m", "radius_m"};
constexpr std::array<Name, 4> box_keys{"centre_m", "size_m", "min_m", "max_m"};
constexpr std::array<Name, 4> disc_keys{"centre_m", "normal", "radius_m", "inner_radius_m"};
constexpr std::array<Name, 3> rectangle_keys{"corner_m", "edge_u_m", "edge_v_m"};
constexpr std::array<Name, 2> plane_keys{"point_m", "normal"};
constexpr std::array<Name, 4> cylinder_keys{"base_m", "apex_m", "radius_m", "capped"};
constexpr std::array<Name, 5> cone_keys{"base_m", "apex_m", "base_radius_m", "apex_radius_m", "capped"};
constexpr std::array<Name, 4> mesh_keys{"positions_m", "faces", "normals", "uvs"};
constexpr std::array<Name, 1> instance_keys{"of"};

struct Reader {
    const TomlTable& t;
    double unit;

    [[nodiscard]] dvec3 point(Name key) const {
        return unit * t.required(t.vec3(key, length_range(unit)), key);
    }
    [[nodiscard]] dvec3 point_or_origin(Name key) const {
        return unit * t.vec3(key, length_range(unit)).value_or(dvec3(0));
    }
    [[nodiscard]] double extent(Name key) const {
        return unit * t.required(t.number(key, extent_range(unit)), key);
    }

    [[nodiscard]] Shape sphere() const { return Sphere{point_or_origin("centre_m"), extent("radius_m")}; }

    [[nodiscard]] Shape box() const {
        if (t.has("min_m") || t.has("max_m")) {
            for (const Name other : {"centre_m", "size_m"}) {
                t.refuse_both("min_m", other);
                t.refuse_both("max_m", other);
            }
            const Box box{point("min_m"), point("max_m")};
            const dvec3 size = box.max - box.min;
            if (!(std::min({size.x, size.y, size.z}) >= extent_range(1).min)) {
                t.fail_at("max_m",
                          "'max_m' does not exceed 'min_m' on every axis (got a size of {:g}, {:g}, {:g} m)",
                          size.x, size.y, size.z);
            }
            return box;
        }
        const dvec3 centre = point_or_origin("centre_m");
        const dvec3 half = 0.5 * unit * t.required(t.number_or_vec3("size_m", extent_range(unit)), "size_m");
        return Box{centre - half, centre + half};
    }

    [[nodiscard]] Shape disc() const {
        Disc disc;
        disc.centre = point_or_origin("centre_m");
        disc.normal = t.required(read_direction(t, "normal"), "normal");
        disc.radius = extent("radius_m");
        disc.inner_radius =
            unit * t.number("inner_radius_m", {.min = 0, .max = extent_range(unit).max}).value_or(0);
        if (!(disc.inner_radius < disc.radius)) {
            t.fail_at("inner_radius_m",
                      "'inner_radius_m' is out of range (got {:g} m; expected less than 'radius_m', {:g} m)",
                      disc.inner_radius, disc.radius);
        }
        return disc;
    }

    [[nodiscard]] Shape rectangle() const {
        const Rectangle r{point("corner_m"), point("edge_u_m"), point("edge_v_m")};
        const double u = glm::length(r.edge_u), v = glm::length(r.edge_v);
        if (!(u >= extent_range(1).min && v >= extent_range(1).min) ||
            !(glm::length(glm::cross(r.edge_u / u, r.edge_v / v)) > 1e-9)) {
            t.fail_here(
                "'edge_u_m' and 'edge_v_m' span no area (expected two edges of different directions)");
        }
        return r;
    }

    [[nodiscard]] Shape plane() const {
        return Plane{point_or_origin("point_m"), t.required(read_direction(t, "normal"), "normal")};
    }

    [[nodiscard]] Shape cone(bool is_cylinder) const {
        Cone cone;
        cone.base = point("base_m");
        cone.apex = point("apex_m");
        if (!(glm::length(cone.apex - cone.base) >= extent_range(1).min)) {
            t.fail_at("apex_m", "'apex_m' and 'base_m' coincide (expected a distance between them)");
        }
        if (is_cylinder) {
            cone.base_radius = cone.apex_radius = extent("radius_m");
        } else {
            const NumberRange radius{.min = 0, .max = extent_range(unit).max};
            cone.base_radius = unit * t.required(t.number("base_radius_m", radius), "base_radius_m");
            cone.apex_radius = unit * t.number("apex_radius_m", radius).value_or(0);
            if (!(std::max(cone.base_radius, cone.apex_radius) >= extent_range(1).min)) {
                t.fail_at("base_radius_m", "both radii are 0 (expected one above)");
            }
        }
        cone.capped = t.flag("capped").value_or(true);
        return cone;
    }

    [[nodiscard]] Shape mesh() const;
};

// Checks one vertex index of a face and converts it to an integer.
std::uint32_t corner(const TomlTable& t, double index, std::size_t face, std::size_t positions) {
    if (!(index >= 0 && index < static_cast<double>(positions)) || index != std::floor(index)) {
        t.fail_at("faces", "face {} has an index out of range (got {}; expected a whole number of 0 to {})",
                  face, index, positions - 1);
    }
    return static_cast<std::uint32_t>(index);
}

void add_face(const TomlTable& t, const std::vector<double>& row, std::size_t face,
              const std::vector<dvec3>& positions, Mesh& mesh) {
    std::vector<std::uint32_t> corners;
    std::vector<dvec3> points;
    for (const double index : row) {
        corners.push_back(corner(t, index, face, positions.size()));
        points.push_back(positions[corners.back()]);
    }
    const Triangulation cut = triangulate(points);
    if (cut.fault != PolygonFault::none) {
        t.fail_at("faces", "face {} {} (expected a simple polygon)", face,
                  cut.fault == PolygonFault::no_area ? "has no area" : "crosses itself");
    }
    for (const glm::uvec3& c : cut.triangles)
        mesh.triangles.emplace_back(corners[c.x], corners[c.y], corners[c.z]);
}

Shape Reader::mesh() const {
    auto mesh = std::make_shared<Mesh>();
    std::vector<dvec3> positions;
    for (const auto& row : t.required(t.rows("positions_m", 3, 3, length_range(unit)), "positions_m")) {
        positions.push_back(unit * dvec3(row[0], row[1], row[2]));
        mesh->positions.emplace_back(positions.back());
    }
    const auto faces = t.required(t.rows("faces", 3, largest_polygon), "faces");
    if (faces.empty() || positions.empty())
        t.fail_at("faces", "the mesh is empty (expected positions and faces)");
    for (std::size_t i = 0; i < faces.size(); ++i) add_face(t, faces[i], i, positions, *mesh);

    const auto normals = t.rows("normals", 3, 3, {.min = -1e12, .max = 1e12});
    const auto uvs = t.rows("uvs", 2, 2, {.min = -1e9, .max = 1e9});
    for (const auto& [key, rows] : {std::pair(Name("normals"), &normals), std::pair(Name("uvs"), &uvs)}) {
        if (*rows && (*rows)->size() != positions.size()) {
            t.fail_at(key, "'{}' has the wrong length (got {}; expected one per position, {})", key,
                      (*rows)->size(), positions.size());
        }
    }
    if (normals) {
        for (const auto& row : *normals) {
            const dvec3 n(row[0], row[1], row[2]);
            if (!(glm::length(n) > 1e-12)) t.fail_at("normals", "a normal has no length (got 0, 0, 0)");
            mesh->normals.emplace_back(glm::normalize(n));
        }
    }
    if (uvs) {
        for (const auto& row : *uvs) mesh->uvs.emplace_back(row[0], row[1]);
    }
    return std::shared_ptr<const Mesh>(std::move(mesh));
}

}  // namespace

std::span<const std::string_view> shape_keys(std::size_t kind) {
    static constexpr std::array<std::span<const Name>, shape_kinds.size()> keys{
        sphere_keys,   box_keys,  disc_keys, rectangle_keys, plane_keys,
        cylinder_keys, cone_keys, mesh_keys, instance_keys};
    return keys[kind];
}

Shape read_shape(const TomlTable& table, std::size_t kind, double metres_per_unit) {
    const Reader reader{table, metres_per_unit};
    switch (kind) {
        case 0:
            return reader.sphere();
        case 1:
            return reader.box();
        case 2:
            return reader.disc();
        case 3:
            return reader.rectangle();
        case 4:
            return reader.plane();
        case 5:
        case 6:
            return reader.cone(kind == 5);
        default:
            assert(kind == 7);
            return reader.mesh();
    }
}

}  // namespace postlens
