#include "tracer/shading_trees/film_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "records/motion/motion_path.h"

namespace postlens {

using glm::dmat4;
using glm::dvec2;
using glm::dvec3;

namespace {

// Testing more bounding balls would take longer than tracing the ray.
constexpr std::size_t most_balls = 64;

// If the camera's pinhole moves during the exposure by less than still * (1 m + the pinhole's distance from
// the origin), this may be a rounding error. Then the camera is assumed only to rotate.
constexpr double still = 1e-9;

}  // namespace

FilmMotion::FilmMotion(const SceneMotion& motion, const Camera& camera, const CameraOverrides& overrides,
                       double from_s, std::span<const double> instants_s) {
    const CameraModel from(camera, from_s, overrides);
    for (const double t : instants_s) {
        const CameraModel& then = cameras_.emplace_back(camera, t, overrides);
        const bool orthographic = then.projection == Camera::Projection::orthographic;
        const bool turned = then.forward != from.forward || then.right != from.right;
        const double moved = glm::length(then.position - from.position);
        camera_moves_ = camera_moves_ || turned || moved > 0;
        parallax_ = parallax_ || (orthographic ? turned : moved > still * (1 + glm::length(from.position)));
    }
    for (const auto& [id, object] : motion.objects) {
        const MotionPath path(object.keys);
        const MotionPath::Pose pose = path.at(from_s);
        const dmat4 rest_from_here = glm::inverse(pose.matrix());
        std::vector<dmat4> moved;
        bool moves = false;
        for (const double t : instants_s) {
            const dmat4 there = path.at(t).matrix();
            moves = moves || there != pose.matrix();
            moved.push_back(there * rest_from_here);
        }
        if (!moves) continue;
        moving_.emplace(id, std::move(moved));
        const dvec3 scale = glm::abs(pose.scale);
        balls_.push_back({pose.point(object.centre_m),
                          object.radius_m * std::max({scale.x, scale.y, scale.z}) * (1 + still)});
    }
}

std::optional<dvec2> FilmMotion::place(std::uint32_t id, const dvec3& point, std::size_t i) const {
    const auto found = moving_.find(id);
    if (found == moving_.end()) return cameras_[i].place(point);
    return cameras_[i].place(dvec3(found->second[i] * glm::dvec4(point, 1)));
}

std::optional<dvec2> FilmMotion::place_of_nothing(const dvec3& direction, const dvec2& at,
                                                  std::size_t i) const {
    const CameraModel& camera = cameras_[i];
    if (camera.projection == Camera::Projection::orthographic) return at;
    return camera.place_at_infinity(direction);
}

bool FilmMotion::may_meet_moving(const dvec3& origin, const dvec3& direction, double t) const {
    if (balls_.size() > most_balls) return true;
    return std::any_of(balls_.begin(), balls_.end(), [&](const Ball& b) {
        const double along = glm::dot(b.centre - origin, direction);
        const dvec3 aside = origin + along * direction - b.centre;
        return along + b.radius >= t && glm::dot(aside, aside) <= b.radius * b.radius;
    });
}

double even_instant(double open_s, double close_s, int i, int count) {
    return i == count - 1 ? close_s : open_s + (close_s - open_s) * (static_cast<double>(i) / (count - 1));
}

std::vector<double> looked_at_instants(const SceneMotion& motion, double open_s, double close_s,
                                       std::span<const double> recorded_s) {
    constexpr int even = 9;
    constexpr std::size_t most_keyframes = 32;  // every sample of the trace is followed to every instant
    std::vector<double> keyframes_s;
    const auto add = [&](const std::vector<TransformKey>& keys) {
        for (const TransformKey& k : keys) {
            if (k.time_s > open_s && k.time_s < close_s) keyframes_s.push_back(k.time_s);
        }
    };
    add(motion.camera);
    for (const auto& [id, object] : motion.objects) add(object.keys);
    std::sort(keyframes_s.begin(), keyframes_s.end());
    keyframes_s.erase(std::unique(keyframes_s.begin(), keyframes_s.end()), keyframes_s.end());
    std::vector<double> out(recorded_s.begin(), recorded_s.end());
    for (int i = 0; i < even; ++i) out.push_back(even_instant(open_s, close_s, i, even));
    if (keyframes_s.size() <= most_keyframes) {
        out.insert(out.end(), keyframes_s.begin(), keyframes_s.end());
    } else {
        for (std::size_t i = 0; i < most_keyframes; ++i) {
            const double turns = std::numbers::phi * static_cast<double>(i);
            const double share = turns - std::floor(turns);
            out.push_back(
                keyframes_s[static_cast<std::size_t>(share * static_cast<double>(keyframes_s.size()))]);
        }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

}  // namespace postlens
