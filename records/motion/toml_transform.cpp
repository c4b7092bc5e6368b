#include "records/motion/toml_transform.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "records/motion/scene_limits.h"

namespace postlens {
namespace {

using glm::dvec3;

constexpr NumberRange angle_range{.min = -1e6, .max = 1e6};
constexpr NumberRange scale_range{.min = 1e-9, .max = 1e9};

glm::dquat turn(double degrees, const dvec3& axis) {
    return glm::angleAxis(glm::radians(degrees), axis);
}

glm::dquat read_quaternion(const TomlTable& table) {
    const auto row = *table.numbers("quaternion", 4, {.min = -1e6, .max = 1e6});
    const glm::dquat q(row[0], row[1], row[2], row[3]);
    if (!(glm::length(q) > 1e-9))
        table.fail_at("quaternion", "'quaternion' has no length (expected w, x, y, z)");
    return glm::normalize(q);
}

glm::dquat read_rotation(const TomlTable& table) {
    table.refuse_both("rotate_degrees", "quaternion");
    if (table.has("quaternion")) {
        table.refuse_both("quaternion", "rotate_axis");
        return read_quaternion(table);
    }
    const auto degrees = table.number_or_vec3("rotate_degrees", angle_range);
    const auto axis = read_direction(table, "rotate_axis");
    if (!degrees) {
        if (axis)
            table.fail_at("rotate_axis", "'rotate_axis' needs 'rotate_degrees' (expected both or neither)");
        return {1, 0, 0, 0};
    }
    if (table.is_array("rotate_degrees")) {
        if (axis) {
            table.fail_at("rotate_axis",
                          "'rotate_axis' stands beside three angles (expected one angle about it)");
        }
        return turn(degrees->z, {0, 0, 1}) * turn(degrees->y, {0, 1, 0}) * turn(degrees->x, {1, 0, 0});
    }
    if (!axis) {
        table.fail_at("rotate_degrees",
                      "one angle needs 'rotate_axis' (expected it, or three angles about x, y, z)");
    }
    return turn(degrees->x, *axis);
}

glm::dmat4 read_matrix(const TomlTable& table, double unit) {
    for (const std::string_view other :
         {"translate_m", "rotate_degrees", "rotate_axis", "quaternion", "scale"}) {
        table.refuse_both("matrix", other);
    }
    const auto rows = *table.rows("matrix", 4, 4, length_range(unit));
    const bool whole = rows.size() == 4 && rows[3] == std::vector<double>{0, 0, 0, 1};
    if (rows.size() != 3 && !whole) {
        table.fail_at(
            "matrix",
            "'matrix' is not affine (got {} rows; expected 3 of 4 numbers, or a fourth of 0, 0, 0, 1)",
            rows.size());
    }
    glm::dmat4 m(1);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            const double value = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
            m[column][row] = column == 3 ? unit * value : value;
        }
    }
    const dvec3 x(m[0]), y(m[1]), z(m[2]);
    const double volume = glm::dot(glm::cross(x, y), z);
    // Rejects a matrix whose determinant is not positive. A negative determinant mirrors the object, which
    // turns its surface inside out. A determinant of 0 flattens it, so that positions in the world cannot be
    // converted back to positions in the object.
    if (!(volume > 1e-12 * glm::length(x) * glm::length(y) * glm::length(z)) || !std::isfinite(volume)) {
        table.fail_at("matrix",
                      "'matrix' flattens or mirrors (got a determinant of {:g}; expected a positive one)",
                      volume);
    }
    return m;
}

TransformKey read_placement(const TomlTable& table, double unit) {
    TransformKey key;
    key.translation = unit * table.vec3("translate_m", length_range(unit)).value_or(dvec3(0));
    key.rotation = read_rotation(table);
    key.scale = table.number_or_vec3("scale", scale_range).value_or(dvec3(1));
    return key;
}

// Throws if an object turns by 180 degrees or more between two keyframes. Slerp takes the smaller angle, so
// the object would turn the wrong way.
void refuse_half_turns(const TomlTable& from, const TomlTable& to) {
    const auto a = from.number_or_vec3("rotate_degrees"), b = to.number_or_vec3("rotate_degrees");
    const dvec3 step = glm::abs(b.value_or(dvec3(0)) - a.value_or(dvec3(0)));
    const double most = std::max({step.x, step.y, step.z});
    if (most >= 180) {
        to.fail_here(
            "the turn since the key before is ambiguous (got {} degrees; expected less than 180: add a key "
            "between)",
            most);
    }
}

}  // namespace

NumberRange length_range(double metres_per_unit) {
    return {.min = -largest_length_m / metres_per_unit, .max = largest_length_m / metres_per_unit};
}

NumberRange extent_range(double metres_per_unit) {
    return {.min = smallest_extent_m / metres_per_unit, .max = largest_length_m / metres_per_unit};
}

std::optional<dvec3> read_direction(const TomlTable& table, std::string_view key) {
    const auto v = table.vec3(key, {.min = -1e12, .max = 1e12});
    if (!v) return std::nullopt;
    const double length = glm::length(*v);
    if (!(length > 1e-12)) table.fail_at(key, "'{}' has no direction (got a length of {:g})", key, length);
    return *v / length;
}

glm::dmat4 read_transform(const TomlTable& table, double metres_per_unit) {
    if (table.has("matrix")) return read_matrix(table, metres_per_unit);
    return transform_at({read_placement(table, metres_per_unit)}, 0);
}

std::vector<TransformKey> read_motion(const TomlTable& table, double metres_per_unit, bool rigid) {
    static constexpr std::array<std::string_view, 5> rigid_names{"time_s", "translate_m", "rotate_degrees",
                                                                 "rotate_axis", "quaternion"};
    static constexpr std::array<std::string_view, 1> scale_name{"scale"};
    std::vector<TransformKey> out;
    const auto tables = table.tables("keys", table.what() + ": key");
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const TomlTable& t = tables[i];
        if (rigid) {
            t.allow_only({rigid_names});
        } else {
            t.allow_only({rigid_names, scale_name});
        }
        TransformKey key = read_placement(t, metres_per_unit);
        key.time_s = t.required(t.number("time_s", {.min = -1e9, .max = 1e9}), "time_s");
        if (i > 0) {
            if (!(key.time_s > out.back().time_s)) {
                t.fail_at("time_s", "'time_s' does not grow (got {} s after {} s)", key.time_s,
                          out.back().time_s);
            }
            refuse_half_turns(tables[i - 1], t);
        }
        out.push_back(key);
    }
    return out;
}

}  // namespace postlens
