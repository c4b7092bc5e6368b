#include "scene/toml/toml_views.h"

#include <array>
#include <set>
#include <string>

#include "core/text.h"
#include "records/motion/scene_limits.h"
#include "records/motion/toml_transform.h"

namespace postlens {
namespace {

using glm::dvec3;
using Name = std::string_view;

// Range of film sizes and focal lengths, mm: wider than real ones, but narrow enough that their quotients are
// finite.
constexpr NumberRange film_range{.min = 1e-6, .max = 1e6};

void read_projection(const TomlTable& t, double unit, Camera& camera) {
    static constexpr std::array<Name, 2> projections{"perspective", "orthographic"};
    static constexpr std::array<Name, 3> angles{"focal_length_mm", "horizontal_fov_degrees",
                                                "vertical_fov_degrees"};
    constexpr NumberRange fov{.min = 1e-3, .max = 179};
    if (t.choice("projection", projections).value_or(0) == 1) {
        camera.projection = Camera::Projection::orthographic;
        for (const Name key : angles) {
            if (t.has(key))
                t.fail_at(key,
                          "'{}' has no meaning for an orthographic camera (expected 'orthographic_width_m')",
                          key);
        }
        camera.orthographic_width_m =
            unit * t.required(t.number("orthographic_width_m", extent_range(unit)), "orthographic_width_m");
        return;
    }
    if (t.has("orthographic_width_m")) {
        t.fail_at("orthographic_width_m",
                  "'orthographic_width_m' has no meaning for a perspective camera (expected "
                  "'focal_length_mm' or an angle)");
    }
    for (std::size_t i = 0; i < angles.size(); ++i) {
        for (std::size_t j = i + 1; j < angles.size(); ++j) t.refuse_both(angles[i], angles[j]);
    }
    camera.focal_length_mm = t.number(angles[0], film_range);
    camera.horizontal_fov_degrees = t.number(angles[1], fov);
    camera.vertical_fov_degrees = t.number(angles[2], fov);
    if (!camera.focal_length_mm && !camera.horizontal_fov_degrees && !camera.vertical_fov_degrees) {
        camera.focal_length_mm = 50;
    }
}

Camera read_camera(const TomlTable& t, double unit) {
    static constexpr std::array<Name, 17> known{"name",
                                                "projection",
                                                "position_m",
                                                "look_at_m",
                                                "up",
                                                "film_width_mm",
                                                "focal_length_mm",
                                                "horizontal_fov_degrees",
                                                "vertical_fov_degrees",
                                                "orthographic_width_m",
                                                "width_px",
                                                "height_px",
                                                "f_number",
                                                "focus_m",
                                                "exposure_s",
                                                "keys",
                                                "look_along"};
    t.allow_only({known});
    Camera camera;
    read_projection(t, unit, camera);
    camera.position = unit * t.vec3("position_m", length_range(unit)).value_or(dvec3(0));
    t.refuse_both("look_at_m", "look_along");
    if (const auto target = t.vec3("look_at_m", length_range(unit))) {
        camera.look_at = unit * *target;
    } else {
        camera.look_at = camera.position + read_direction(t, "look_along").value_or(dvec3(0, 0, -1));
    }
    camera.up = read_direction(t, "up").value_or(camera.up);
    const dvec3 forward = camera.look_at - camera.position;
    if (!(glm::length(glm::cross(forward, camera.up)) > 1e-9 * glm::length(forward)) || forward == dvec3(0)) {
        t.fail_here(
            "'position_m', the view's direction and 'up' do not span a view (expected three that do)");
    }
    camera.film_width_mm = t.number("film_width_mm", film_range).value_or(camera.film_width_mm);
    camera.width = t.integer("width_px", 1, largest_raster_px).value_or(camera.width);
    camera.height = t.integer("height_px", 1, largest_raster_px).value_or(camera.height);
    camera.f_number = t.number("f_number", {.min = 1e-3, .max = 1e6, .may_be_infinite = true});
    NumberRange focus = extent_range(unit);
    focus.may_be_infinite = true;
    if (const auto distance = t.number("focus_m", focus)) camera.focus_m = unit * *distance;
    camera.exposure_s = t.number("exposure_s", {.min = 0, .max = 1e9});
    camera.keys = read_motion(t, unit, true);
    return camera;
}

void read_spot(const TomlTable& t, Light& light) {
    constexpr NumberRange cone{.min = 0, .max = 180, .excludes_min = true};
    light.cone_degrees = t.number("cone_degrees", cone).value_or(light.cone_degrees);
    light.cone_soft_degrees =
        t.number("cone_soft_degrees", {.min = 0, .max = 180}).value_or(light.cone_degrees);
    if (light.cone_soft_degrees > light.cone_degrees) {
        t.fail_at("cone_soft_degrees",
                  "'cone_soft_degrees' is out of range (got {}; expected at most 'cone_degrees', {})",
                  light.cone_soft_degrees, light.cone_degrees);
    }
}

Light read_light(const TomlTable& t, double unit) {
    static constexpr std::array<Name, 5> kinds{"point", "directional", "spot", "sphere", "rectangle"};
    static constexpr std::array<Name, 5> common{"name", "kind", "intensity", "casts_shadows", "keys"};
    static constexpr std::array<Name, 2> placed{"position_m", "attenuation"};
    static constexpr std::array<Name, 1> aimed{"direction"};
    static constexpr std::array<Name, 2> spot{"cone_degrees", "cone_soft_degrees"};
    static constexpr std::array<Name, 1> sphere{"radius_m"};
    static constexpr std::array<Name, 2> rectangle{"edge_u_m", "edge_v_m"};
    if (!t.has("kind")) t.allow_only({common, placed, aimed, spot, sphere, rectangle});
    Light light;
    light.kind = static_cast<Light::Kind>(t.required(t.choice("kind", kinds), "kind"));
    const bool has_place = light.kind != Light::Kind::directional;
    const bool is_spot = light.kind == Light::Kind::spot;
    const bool has_aim = is_spot || light.kind == Light::Kind::directional;
    const bool is_sphere = light.kind == Light::Kind::sphere,
               is_rectangle = light.kind == Light::Kind::rectangle;
    using List = std::span<const Name>;
    t.allow_only({common, has_place ? List(placed) : List(), has_aim ? List(aimed) : List(),
                  is_spot        ? List(spot)
                  : is_sphere    ? List(sphere)
                  : is_rectangle ? List(rectangle)
                                 : List()});
    light.intensity =
        t.number_or_vec3("intensity", {.min = 0, .max = largest_colour}).value_or(light.intensity);
    light.casts_shadows = t.flag("casts_shadows").value_or(light.casts_shadows);
    if (has_place) {
        light.position = unit * t.required(t.vec3("position_m", length_range(unit)), "position_m");
        light.attenuation = t.vec3("attenuation", {.min = 0, .max = 1e12}).value_or(light.attenuation);
        if (light.attenuation == dvec3(0))
            t.fail_at("attenuation", "'attenuation' is 0 everywhere (expected one term above)");
        // The attenuation of a light is 1 / (a0 + a1 r + a2 r^2). The file gives a1 and a2 for a distance r
        // in scene units, but here r is in metres. `unit` is the number of metres per scene unit.
        light.attenuation /= dvec3(1, unit, unit * unit);
    }
    if (has_aim) light.direction = t.required(read_direction(t, "direction"), "direction");
    if (is_spot) read_spot(t, light);
    if (is_sphere) light.radius = unit * t.required(t.number("radius_m", extent_range(unit)), "radius_m");
    if (is_rectangle) {
        light.edge_u = unit * t.required(t.vec3("edge_u_m", length_range(unit)), "edge_u_m");
        light.edge_v = unit * t.required(t.vec3("edge_v_m", length_range(unit)), "edge_v_m");
        if (!(glm::length(glm::cross(light.edge_u, light.edge_v)) >
              1e-9 * glm::length(light.edge_u) * glm::length(light.edge_v))) {
            t.fail_at("edge_v_m", "'edge_u_m' and 'edge_v_m' span no area (expected two that do)");
        }
    }
    light.keys = read_motion(t, unit, true);
    return light;
}

// Reads all tables of one kind. Tables without a name are numbered. Repeated names are an error.
template <typename Read>
auto read_named(const TomlTable& root, const std::string& key, const Read& read) {
    std::vector<decltype(read(root))> out;
    std::set<std::string> names;
    for (TomlTable& t : root.tables(key, key)) {
        const auto name = t.text("name");
        if (name) t.rename(fmt::format("{} '{}'", key, *name));
        out.push_back(read(t));
        out.back().name = name.value_or(fmt::format("{} {}", key, out.size()));
        if (!names.insert(out.back().name).second)
            t.fail_at("name", "two of a kind have the name {}", excerpt(*name));
    }
    return out;
}

}  // namespace

std::vector<Camera> read_cameras(const TomlTable& root, double metres_per_unit) {
    return read_named(root, "camera", [&](const TomlTable& t) { return read_camera(t, metres_per_unit); });
}

std::vector<Light> read_lights(const TomlTable& root, double metres_per_unit) {
    return read_named(root, "light", [&](const TomlTable& t) { return read_light(t, metres_per_unit); });
}

}  // namespace postlens
