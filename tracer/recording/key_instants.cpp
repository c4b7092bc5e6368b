#include "tracer/recording/key_instants.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <optional>

#include "core/threads.h"
#include "records/motion/motion_path.h"
#include "records/sample_header.h"
#include "scene/shape_bounds.h"
#include "tracer/shading_trees/film_motion.h"

namespace postlens {
namespace {

using glm::dvec3;

// Number of steps into which the shutter interval is divided. The instants of the motion's keyframes are
// added. Between two steps, directions are assumed to turn by less than 180 degrees.
constexpr int steps = 512;

double angle(const dvec3& a, const dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Position and viewing direction of the camera at an instant.
struct View {
    double time_s = 0;
    dvec3 position{0}, backwards{0, 0, 1};
    View(const Camera& camera, double at_s) : time_s(at_s) {
        const CameraModel model(camera, at_s);
        position = model.position;
        backwards = -model.forward;
    }
};

// Returns the camera poses `views`, and between the first and the last of them also the poses at the
// keyframes of the camera's motion.
std::vector<View> with_keys(const std::vector<View>& views, const Camera& camera,
                            const std::vector<TransformKey>& keys) {
    std::vector<View> out = views;
    for (const TransformKey& k : keys) {
        if (k.time_s > views.front().time_s && k.time_s < views.back().time_s)
            out.emplace_back(camera, k.time_s);
    }
    std::sort(out.begin(), out.end(), [](const View& a, const View& b) { return a.time_s < b.time_s; });
    return out;
}

bool inside(const Bounds& box, const dvec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
}

// Instants at which directions are computed: evenly spaced instants of the shutter interval, and the
// keyframes within it.
std::vector<double> looks(const TimeSpan& shutter, int count,
                          std::initializer_list<const std::vector<TransformKey>*> motions) {
    std::vector<double> out;
    for (int i = 0; i <= count; ++i)
        out.push_back(even_instant(shutter.open_s, shutter.close_s, i, count + 1));
    for (const std::vector<TransformKey>* keys : motions) {
        for (const TransformKey& k : *keys) {
            if (k.time_s > shutter.open_s && k.time_s < shutter.close_s) out.push_back(k.time_s);
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

bool responds_to_lights(const Material& m) {
    return m.diffuse != dvec3(0) || m.diffuse_transmission != dvec3(0) || m.specular != dvec3(0);
}

// Total rotation, degrees, of the direction to the light from a point of an object, in the object's frame.
// `rest`: the point without the object's motion.
double light_sweep(const Object& object, const dvec3& rest, const Light& light, const TimeSpan& shutter) {
    constexpr int light_steps = 64;
    const MotionPath of_object(object.keys), of_light(light.keys);
    if (!of_object.moves(shutter.open_s, shutter.close_s) && !of_light.moves(shutter.open_s, shutter.close_s))
        return 0;
    double sum = 0;
    std::optional<dvec3> last;
    for (const double t : looks(shutter, light_steps, {&object.keys, &light.keys})) {
        const MotionPath::Pose pose = of_object.at(t), lamp = of_light.at(t);
        const dvec3 way = light.kind == Light::Kind::directional
                              ? -lamp.direction(light.direction)
                              : lamp.point(light.position) - pose.point(rest);
        const dvec3 d = way * pose.rotation;  // the transpose of the rotation times `way`
        if (last) sum += angle(*last, d);
        last = d;
    }
    return glm::degrees(sum);
}

// Points that a coarse grid of rays sees.
std::vector<SurfacePoint> visible_points(const RayScene& rays, const CameraModel& camera) {
    constexpr int across = 32, down = 16;
    std::vector<CameraRay> eye;
    RayBatch batch;
    batch.clear(false);
    for (int y = 0; y < down; ++y) {
        for (int x = 0; x < across; ++x) {
            const CameraRay& r = eye.emplace_back(
                camera.ray((x + 0.5) / across * camera.width, (y + 0.5) / down * camera.height));
            batch.add(r.origin, r.direction, std::numeric_limits<float>::infinity());
        }
    }
    rays.intersect(batch, false);
    std::vector<SurfacePoint> out;
    for (std::size_t i = 0; i < eye.size(); ++i) {
        if (!batch.hit(i).valid()) continue;
        out.push_back(
            rays.surface(batch.hit(i), eye[i].origin, eye[i].direction, static_cast<double>(batch.t[i])));
    }
    return out;
}

double sweep(const Object& object, const std::vector<View>& views, bool orthographic) {
    const bool moves = !object.keys.empty();
    const Bounds box = shape_bounds(object.shape, moves ? object.motion_base : object.world_from_object);
    const dvec3 size = box.max - box.min;
    if (box.empty() || !(std::isfinite(size.x) && std::isfinite(size.y) && std::isfinite(size.z))) return 0;
    const dvec3 centre = 0.5 * (box.min + box.max);
    const MotionPath path(object.keys);
    double sum = 0;
    bool before = false;
    dvec3 last(0);
    for (const View& v : views) {
        const MotionPath::Pose pose = path.at(v.time_s);
        const dvec3 seen_from = pose.unmoved_point(v.position);
        const dvec3 d = orthographic ? pose.unmoved_direction(v.backwards) : seen_from - centre;
        const bool counts = orthographic || !inside(box, seen_from);
        if (counts && before) sum += angle(last, d);
        before = counts;
        last = d;
    }
    return sum * 180 / std::numbers::pi;
}

}  // namespace

double view_sweep_degrees(const Scene& scene, const Camera& camera, const TimeSpan& shutter) {
    if (!(shutter.close_s > shutter.open_s)) return 0;
    std::vector<View> views;
    for (int i = 0; i <= steps; ++i) {
        views.emplace_back(camera, even_instant(shutter.open_s, shutter.close_s, i, steps + 1));
    }
    views = with_keys(views, camera, camera.keys);
    const bool camera_moves = std::any_of(views.begin(), views.end(), [&](const View& v) {
        return v.position != views.front().position || v.backwards != views.front().backwards;
    });
    const bool orthographic = camera.projection == Camera::Projection::orthographic;
    std::vector<double> sweeps(scene.objects.size(), 0);
    parallel_for(sweeps.size(), [&](std::size_t i) {
        const Object& o = scene.objects[i];
        if (!o.keys.empty()) {
            sweeps[i] = sweep(o, with_keys(views, camera, o.keys), orthographic);
        } else if (camera_moves) {
            sweeps[i] = sweep(o, views, orthographic);
        }
    });
    return sweeps.empty() ? 0 : *std::max_element(sweeps.begin(), sweeps.end());
}

double light_sweep_degrees(const Scene& scene, const CameraModel& camera, double recorded_s,
                           const TimeSpan& shutter) {
    const auto moves = [&](const auto& of) {
        return MotionPath(of.keys).moves(shutter.open_s, shutter.close_s);
    };
    if (scene.lights.empty()) return 0;
    if (std::none_of(scene.lights.begin(), scene.lights.end(), moves) &&
        std::none_of(scene.objects.begin(), scene.objects.end(), moves))
        return 0;
    const std::vector<SurfacePoint> points = visible_points(RayScene(scene, recorded_s), camera);
    std::vector<double> sweeps(points.size(), 0);
    parallel_for(points.size(), [&](std::size_t i) {
        const Object& o = scene.objects[points[i].object];
        if (!responds_to_lights(scene.materials[o.material])) return;
        const dvec3 rest = MotionPath(o.keys).at(recorded_s).unmoved_point(points[i].position);
        for (const Light& light : scene.lights)
            sweeps[i] = std::max(sweeps[i], light_sweep(o, rest, light, shutter));
    });
    return sweeps.empty() ? 0 : *std::max_element(sweeps.begin(), sweeps.end());
}

double pan_degrees(const Camera& camera, const TimeSpan& shutter) {
    if (camera.projection == Camera::Projection::orthographic || !(shutter.close_s > shutter.open_s))
        return 0;
    double sum = 0;
    std::optional<dvec3> last;
    for (const double t : looks(shutter, steps, {&camera.keys})) {
        const dvec3 backwards = View(camera, t).backwards;
        if (last) sum += angle(*last, backwards);
        last = backwards;
    }
    return glm::degrees(sum);
}

double half_field_degrees(const CameraModel& camera) {
    return glm::degrees(std::atan(camera.tangent_per_px * std::min(camera.width, camera.height) / 2));
}

KeyCount automatic_keys(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                        double recorded_s, const TimeSpan& shutter, double degrees_per_key) {
    const CameraModel model(camera, recorded_s, overrides);
    KeyCount out;
    const auto need = [&](double sweep_degrees, double per_key, const char* what) {
        const int keys = keys_for_sweep(sweep_degrees, per_key);
        if (*out.what == '\0' || keys > out.keys) out = {keys, sweep_degrees, what};
    };
    need(view_sweep_degrees(scene, camera, shutter), degrees_per_key, "something");
    need(light_sweep_degrees(scene, model, recorded_s, shutter), degrees_per_key, "the light on something");
    const double pan = pan_degrees(camera, shutter);
    if (pan > 0) need(pan, half_field_degrees(model), "the camera");
    return out;
}

int keys_for_sweep(double sweep_degrees, double degrees_per_key) {
    // Tolerance for the rounding of the sum over the steps. With it, a sweep of exactly 60 degrees needs no
    // additional key.
    constexpr double rounding = 1e-6;
    if (sweep_degrees <= degrees_per_key * (1 + rounding)) return 1;
    const double keys = 1 + std::ceil(sweep_degrees / degrees_per_key - rounding);
    return static_cast<int>(std::min(keys, static_cast<double>(SampleHeader::most_keys)));
}

std::vector<double> key_instants(int count, const TimeSpan& shutter, double frame_s) {
    std::vector<double> out;
    if (count < 2) return out;
    for (int i = 0; i < count; ++i) {
        const double t = even_instant(shutter.open_s, shutter.close_s, i, count);
        const double least =
            1e-9 * std::max({std::abs(t), std::abs(frame_s), shutter.close_s - shutter.open_s});
        const bool again = !out.empty() && !(t > out.back());
        if (!again && std::abs(t - frame_s) > least) out.push_back(t);
    }
    return out;
}

}  // namespace postlens
