#include "tracer/recording/key_instants.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <utility>

#include "core/job.h"
#include "core/threads.h"
#include "records/motion/motion_path.h"
#include "records/sample_header.h"
#include "scene/shape_bounds.h"
#include "tracer/recording/light_keys.h"
#include "tracer/shading_trees/film_motion.h"

namespace postlens {
namespace {

using glm::dvec3;

// Number of equal steps into which the shutter interval is divided to measure the motion of objects and
// camera. A turn is measured as the angle between two directions, so it must be less than 180 degrees per
// step.
constexpr int steps = 512;

// Objects may change their size by keyframes. If the only recorded instant shows such an object while it is
// small, few samples hit it, and these are too coarse for the instants at which it is large. So an instant
// must be recorded at which the object's scale is at least this fraction of its largest scale.
constexpr double least_size = 0.5;

double angle(const dvec3& a, const dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

struct View {
    double time_s = 0;
    dvec3 position{0}, backwards{0, 0, 1};
    View(const Camera& camera, double at_s) : time_s(at_s) {
        const CameraModel model(camera, at_s);
        position = model.position;
        backwards = -model.forward;
    }
};

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

// Returns the instants at which motion is examined, in ascending order: count + 1 evenly spaced instants of
// the shutter interval, and all keyframes within this interval.
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

// Returns whether part of a moving sphere may be in view: in front of the camera and within the frame.
// `centre` and `radius_m` describe the sphere before the motion `pose` is applied.
bool may_see(const CameraModel& camera, const MotionPath::Pose& pose, const dvec3& centre, double radius_m) {
    const dvec3 from_camera = pose.point(centre) - camera.position, scale = glm::abs(pose.scale);
    const double radius = radius_m * std::max({scale.x, scale.y, scale.z}),
                 ahead = glm::dot(from_camera, camera.forward);
    const auto is_between = [&](const dvec3& axis, int size_px) {
        const double aside = std::abs(glm::dot(from_camera, axis));
        if (camera.projection == Camera::Projection::orthographic)
            return aside < radius + camera.pixel_pitch_mm / 1000 * size_px / 2;
        const double tangent = camera.tangent_per_px * size_px / 2;
        return aside - tangent * ahead < radius * std::hypot(1, tangent);
    };
    return ahead > -radius && is_between(camera.right, camera.width) &&
           is_between(camera.down, camera.height);
}

// Returns whether at least one corner of `box`, after the motion `pose`, is in front of the camera.
bool is_ahead(const CameraModel& camera, const MotionPath::Pose& pose, const Bounds& box) {
    for (int k = 0; k < 8; ++k) {
        const dvec3 corner((k & 1) != 0 ? box.max.x : box.min.x, (k & 2) != 0 ? box.max.y : box.min.y,
                           (k & 4) != 0 ? box.max.z : box.min.z);
        if (glm::dot(pose.point(corner) - camera.position, camera.forward) > 0) return true;
    }
    return false;
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

int keys_for_visits(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                    double recorded_s, const TimeSpan& shutter, int at_least) {
    std::vector<CameraModel> cameras;
    std::vector<double> instants_s;
    for (int i = 0; i <= steps; ++i) {
        instants_s.push_back(even_instant(shutter.open_s, shutter.close_s, i, steps + 1));
        cameras.emplace_back(camera, instants_s.back(), overrides);
    }
    std::vector<TimeSpan> visits;
    const auto add_spans = [&](const auto& holds) {
        bool before = false;
        for (std::size_t i = 0; i < instants_s.size(); ++i) {
            const bool now = holds(i);
            if (now && !before) visits.push_back({instants_s[i], instants_s[i]});
            if (now) visits.back().close_s = instants_s[i];
            before = now;
        }
    };
    const bool camera_moves = MotionPath(camera.keys).moves(shutter.open_s, shutter.close_s);
    for (const Object& o : scene.objects) {
        throw_if_interrupted();
        const MotionPath path(o.keys);
        const bool object_moves = path.moves(shutter.open_s, shutter.close_s);
        if (!object_moves && !camera_moves) continue;
        const Bounds box = shape_bounds(o.shape, o.keys.empty() ? o.world_from_object : o.motion_base);
        const double radius_m = 0.5 * glm::length(box.max - box.min);
        if (box.empty() || !std::isfinite(radius_m)) continue;
        std::vector<dvec3> sizes;
        std::vector<bool> surrounds;  // whether the camera is inside the bounding box
        dvec3 largest(0);
        for (std::size_t i = 0; i < instants_s.size(); ++i) {
            const MotionPath::Pose pose = path.at(instants_s[i]);
            const bool in_view = may_see(cameras[i], pose, 0.5 * (box.min + box.max), radius_m);
            sizes.push_back(in_view ? glm::abs(pose.scale) : dvec3(0));
            largest = glm::max(largest, sizes.back());
            surrounds.push_back(inside(box, pose.unmoved_point(cameras[i].position)));
        }
        if (object_moves) {
            add_spans([&](std::size_t i) {
                return sizes[i] != dvec3(0) &&
                       glm::all(glm::greaterThanEqual(sizes[i], least_size * largest));
            });
        }
        // `surrounds` tells for each tested instant whether the camera is inside the object's bounding box.
        // From inside, the camera sees other surfaces of the object than from outside. So if the camera is
        // inside for only a part of the time, two instants must be recorded: one while it is inside, and one
        // while it is outside and has the object in view.
        if (std::find(surrounds.begin(), surrounds.end(), true) == surrounds.end()) continue;
        add_spans([&](std::size_t i) { return surrounds[i]; });
        add_spans([&](std::size_t i) {
            return !surrounds[i] && sizes[i] != dvec3(0) && is_ahead(cameras[i], path.at(instants_s[i]), box);
        });
    }
    std::erase_if(visits,
                  [&](const TimeSpan& v) { return v.open_s <= recorded_s && recorded_s <= v.close_s; });
    // Returns true if one of `keys` recorded instants, which are evenly spaced over the shutter interval,
    // lies in the time span `visit`. This is a span in which the scene must be recorded at least once, for
    // example because an object is in view only then.
    const auto has_key = [&](const TimeSpan& visit, int keys) {
        const double length = shutter.close_s - shutter.open_s, gap = 1.0 / (keys - 1);
        const double first = std::ceil((visit.open_s - shutter.open_s) / length / gap) * gap;
        return shutter.open_s + first * length <= visit.close_s;
    };
    constexpr auto most = static_cast<int>(SampleHeader::most_keys);
    std::erase_if(visits, [&](const TimeSpan& v) {
        for (int keys = 2; keys <= most; ++keys) {
            if (has_key(v, keys)) return false;
        }
        return true;
    });
    int keys = std::max(at_least, visits.empty() ? 1 : 2);
    while (keys < most &&
           !std::all_of(visits.begin(), visits.end(), [&](const TimeSpan& v) { return has_key(v, keys); }))
        ++keys;
    return keys;
}

KeyCount automatic_keys(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                        double recorded_s, const TimeSpan& shutter, const KeyRules& rules) {
    const double turn = view_sweep_degrees(scene, camera, shutter), pan = pan_degrees(camera, shutter);
    KeyCount out{keys_for_sweep(turn, rules.degrees_per_key), turn,
                 fmt::format("something turns by {:.4g} degrees", turn)};
    const int for_pan = keys_for_sweep(pan, half_field_degrees(CameraModel(camera, recorded_s, overrides)));
    if (for_pan > out.keys) out = {for_pan, pan, fmt::format("the camera turns by {:.4g} degrees", pan)};
    const auto need = [&out](int keys, std::string reason) {
        if (keys <= out.keys) return;
        out.keys = keys;
        out.reason = std::move(reason);
    };
    if (out.keys < most_light_keys) {
        const LightKeys light =
            light_keys(scene, camera, overrides, recorded_s, shutter, rules.light_db, rules.tracing);
        need(light.keys, fmt::format("light changes: {:.1f} dB of its mean (predicted)", light.psnr_db));
    }
    need(keys_for_visits(scene, camera, overrides, recorded_s, shutter, out.keys),
         "something is in view or large for a short time");
    return out;
}

int keys_for_sweep(double sweep_degrees, double degrees_per_key) {
    // Tolerance for rounding errors. `sweep_degrees`, the angle by which an object turns relative to the
    // camera, is the sum of many small angles. If it exceeds a multiple of `degrees_per_key` only because of
    // rounding, this must not cause another recorded instant.
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
