#include "scene/scene_defaults.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "records/motion/scene_limits.h"
#include "scene/shape_bounds.h"

namespace postlens {
namespace {

using glm::dvec3;

// Returns the bounding box of all finite objects at rest. It is empty if all objects are planes.
Bounds finite_bounds(const Scene& scene, const std::filesystem::path& path) {
    Bounds all;
    for (const Object& object : scene.objects) {
        if (std::holds_alternative<Plane>(object.shape)) continue;
        const Bounds box = shape_bounds(object.shape, object.world_from_object);
        const dvec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
        if (!(std::max({reach.x, reach.y, reach.z}) <= largest_length_m)) {
            fail(ExitCode::invalid_input,
                 "{}: object '{}' reaches too far (expected at most {} m from the origin)", path.string(),
                 object.name, largest_length_m);
        }
        all.add(box);
    }
    return all;
}

Camera framing_camera(const Bounds& box, const dvec3& from) {
    Camera camera;
    camera.name = "made camera";
    camera.focal_length_mm = 50;
    dvec3 centre(0);
    double radius = 1;
    if (!box.empty()) {
        centre = 0.5 * (box.min + box.max);
        radius = std::max(0.5 * glm::length(box.max - box.min), smallest_extent_m);
    }
    // Places the camera so far away that the bounding sphere of the scene fits the height of the film.
    const double film_height_mm = camera.film_width_mm * camera.height / camera.width;
    const double half_angle = std::atan(0.5 * film_height_mm / *camera.focal_length_mm);
    camera.position = centre + radius / std::sin(half_angle) * from;
    camera.look_at = centre;
    return camera;
}

// Default direction from the scene to the camera: from the right and above. A floor is then not seen edge-on,
// and the visible sides of a box differ in brightness.
const dvec3 usual_side = glm::normalize(dvec3(0.3, 0.4, 1));

Light eye_light(const Camera& camera, double time_s, double intensity) {
    const glm::dmat4 moved = transform_at(camera.keys, time_s);
    Light light;
    light.name = "made light";
    light.intensity = dvec3(intensity);
    light.position = dvec3(moved * glm::dvec4(camera.position, 1));
    light.direction = glm::normalize(glm::dmat3(moved) * (camera.look_at - camera.position));
    if (camera.projection == Camera::Projection::orthographic) light.kind = Light::Kind::directional;
    return light;
}

}  // namespace

std::optional<dvec3> open_side(const Scene& scene) {
    dvec3 sum(0);
    double area = 0;
    for (const Object& o : scene.objects) {
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape);
        if (!mesh) continue;
        const glm::dmat3 linear(o.world_from_object);
        for (const glm::uvec3& t : (*mesh)->triangles) {
            const dvec3 a((*mesh)->positions[t.x]);
            const dvec3 n = glm::cross(linear * (dvec3((*mesh)->positions[t.y]) - a),
                                       linear * (dvec3((*mesh)->positions[t.z]) - a));
            sum += n;
            area += glm::length(n);
        }
    }
    constexpr double least_share = 0.1;
    const dvec3 level(sum.x, 0, sum.z);
    const double length = glm::length(level);
    if (!(length > least_share * area) || !(length > std::abs(sum.y))) return std::nullopt;
    return level / length;
}

bool answers_to_lights(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
        return m.diffuse + m.diffuse_transmission + m.specular != dvec3(0);
    });
}

void complete_scene(Scene& scene, const std::filesystem::path& path, bool wants_light, double light_intensity,
                    std::optional<dvec3> view_from) {
    if (scene.objects.empty()) {
        fail(ExitCode::invalid_input,
             "{}: the scene has no objects (expected at least one that is not hidden)", path.string());
    }
    const Bounds box = finite_bounds(scene, path);
    if (scene.cameras.empty()) {
        const Camera camera = framing_camera(box, view_from.value_or(usual_side));
        scene.notes.push_back(fmt::format(
            "no camera in the scene: made one of 50 mm at ({:.4g}, {:.4g}, {:.4g}) m that frames everything",
            camera.position.x, camera.position.y, camera.position.z));
        scene.cameras.push_back(camera);
    }
    if (scene.lights.empty() && wants_light) {
        scene.lights.push_back(eye_light(scene.cameras.front(), scene.time_s, light_intensity));
        scene.notes.push_back(
            fmt::format("no light in the scene: made one of intensity {:.4g} at the eye", light_intensity));
    }
}

}  // namespace postlens
