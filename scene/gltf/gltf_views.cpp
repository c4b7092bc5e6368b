#include "scene/gltf/gltf_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "records/motion/scene_limits.h"

namespace postlens {
namespace {

using glm::dvec3;

// Height of the raster, px. glTF states only the camera's aspect ratio, width / height.
constexpr int height_px = 540;
constexpr double least_aspect = 0.01, most_aspect = 100;

int width_px(double aspect) {
    return static_cast<int>(std::lround(height_px * std::clamp(aspect, least_aspect, most_aspect)));
}

std::string name_of(const JsonPlace& node, const JsonPlace& thing) {
    return printable_name(node.text("name").value_or(""),
                          printable_name(thing.text("name").value_or(""), thing.where()));
}

}  // namespace

std::optional<Camera> gltf_camera(const GltfDocument& document, const JsonPlace& node, double unit) {
    const auto index = node.index("camera", document.count("cameras"));
    if (!index) return std::nullopt;
    const JsonPlace c = document.item("cameras", *index);
    Camera camera;
    camera.name = name_of(node, c);
    camera.height = height_px;
    const std::string type = c.required(c.text("type"), "type");
    if (type == "perspective") {
        const JsonPlace p = c.required(c.object("perspective"), "perspective");
        const double yfov = p.required(p.number("yfov", 1e-5, 3.124), "yfov");
        camera.vertical_fov_degrees = yfov * 180 / std::numbers::pi;
        camera.width = width_px(p.number("aspectRatio", 1e-6, 1e6).value_or(16.0 / 9));
    } else if (type == "orthographic") {
        const JsonPlace o = c.required(c.object("orthographic"), "orthographic");
        // Some published files contain negative magnifications. The sign has no meaning.
        const double x = std::abs(o.required(o.number("xmag", -largest_length_m, largest_length_m), "xmag"));
        const double y = std::abs(o.required(o.number("ymag", -largest_length_m, largest_length_m), "ymag"));
        if (!(x * unit >= smallest_extent_m && y * unit >= smallest_extent_m)) {
            o.fail_here("has no size (got {} x {}; expected more than 0)", x, y);
        }
        camera.projection = Camera::Projection::orthographic;
        camera.orthographic_width_m = 2 * x * unit;
        camera.width = width_px(x / y);
    } else {
        c.fail_here("is of an unknown type (got {}; expected perspective or orthographic)", excerpt(type));
    }
    return camera;
}

std::optional<Light> gltf_light(const GltfDocument& document, const JsonPlace& node,
                                const SceneReadOptions& options, SceneNotes& notes) {
    const auto use = node.extension("KHR_lights_punctual");
    if (!use) return std::nullopt;
    const auto all = document.root().extension("KHR_lights_punctual");
    const auto lights = all ? all->objects("lights") : std::vector<JsonPlace>{};
    const JsonPlace& l = lights[use->required(use->index("light", lights.size()), "light")];
    const double unit = options.metres_per_unit;
    Light light;
    light.name = name_of(node, l);
    const auto colour = l.numbers("color", 3, 0, largest_colour);
    light.intensity =
        (colour ? dvec3((*colour)[0], (*colour)[1], (*colour)[2]) : dvec3(1)) *
        (l.number("intensity", 0, largest_colour).value_or(1) / (std::numbers::pi * options.lumens_per_watt));
    const std::string type = l.required(l.text("type"), "type");
    if (type == "directional") {
        light.kind = Light::Kind::directional;
        return light;
    }
    if (type != "point" && type != "spot") {
        l.fail_here("is of an unknown type (got {}; expected directional, point or spot)", excerpt(type));
    }
    light.kind = type == "point" ? Light::Kind::point : Light::Kind::spot;
    // The light decreases with the squared distance from its source. Distances in the scene are in m, but the
    // decrease must depend on the distance in units of the file. `unit` is the number of metres per unit, so
    // the squares are divided by unit^2.
    light.attenuation = dvec3(0, 0, 1 / (unit * unit));
    if (l.has("range")) notes.add("the range of a light is left out: it shines on beyond it");
    if (light.kind == Light::Kind::spot) {
        constexpr double quarter_turn = std::numbers::pi / 2;
        const auto spot = l.object("spot");
        const auto angle = [&](const char* key, double otherwise) {
            return spot ? spot->number(key, 0, quarter_turn + 1e-6).value_or(otherwise) : otherwise;
        };
        const double outer = angle("outerConeAngle", quarter_turn / 2), inner = angle("innerConeAngle", 0);
        if (!(outer > inner)) {
            l.fail_here(
                "has a spot with no width (got angles of {} and {}; expected the outer one to be larger)",
                inner, outer);
        }
        light.cone_degrees = std::min(outer * 360 / std::numbers::pi, 180.0);
        light.cone_soft_degrees = std::min(inner * 360 / std::numbers::pi, light.cone_degrees);
    }
    return light;
}

}  // namespace postlens
