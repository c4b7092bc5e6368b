#include "records/motion/motion_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace postlens {

using glm::dmat3;
using glm::dmat4;
using glm::dquat;
using glm::dvec3;

namespace {

MotionPath::Pose pose_of(const TransformKey& key) {
    return {key.translation, glm::mat3_cast(key.rotation), key.scale};
}

}  // namespace

dmat4 MotionPath::Pose::matrix() const {
    dmat4 m(rotation);
    for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[axis];
    m[3] = glm::dvec4(translation, 1);
    return m;
}

MotionPath::MotionPath(const std::vector<TransformKey>& keys) {
    if (keys.empty()) return;
    first_ = pose_of(keys.front());
    last_ = pose_of(keys.back());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        times_s_.push_back(keys[i].time_s);
        if (i == 0) continue;
        const TransformKey &a = keys[i - 1], &b = keys[i];
        Interval v;
        v.begin_s = a.time_s;
        v.per_s = 1 / (b.time_s - a.time_s);
        v.translation = a.translation;
        v.translation_step = b.translation - a.translation;
        v.scale = a.scale;
        v.scale_step = b.scale - a.scale;
        v.from = a.rotation;
        // Prepares the interpolation between the rotations of the keys a and b. The quaternions q and -q
        // describe the same rotation, and the sign that gives the smaller angle is chosen, as in glm::slerp.
        double cosine = glm::dot(a.rotation, b.rotation);
        v.to = cosine < 0 ? -b.rotation : b.rotation;
        cosine = std::abs(cosine);
        v.turns = v.to != v.from;
        v.rotation = glm::mat3_cast(v.from);
        // If the sine of the angle is nearly 0, `inverse_sine` is not set, and the interpolation is linear.
        if (cosine <= 1 - std::numeric_limits<double>::epsilon()) {
            v.angle = std::acos(cosine);
            v.inverse_sine = 1 / std::sin(v.angle);
        }
        intervals_.push_back(v);
    }
}

MotionPath::Pose MotionPath::at(double time_s) const {
    if (times_s_.empty()) return {};
    if (!(time_s > times_s_.front())) return first_;
    if (time_s >= times_s_.back()) return last_;
    // Most motion has only two keys, and therefore only one interval.
    std::size_t i = 0;
    if (intervals_.size() > 1)
        i = static_cast<std::size_t>(std::upper_bound(times_s_.begin(), times_s_.end(), time_s) -
                                     times_s_.begin()) -
            1;
    const Interval& v = intervals_[i];
    const double share = (time_s - v.begin_s) * v.per_s;
    Pose p;
    p.translation = v.translation + share * v.translation_step;
    p.scale = v.scale + share * v.scale_step;
    p.rotation = v.rotation;
    if (v.turns) {
        const bool lerp = v.angle == 0;
        const double a = lerp ? 1 - share : std::sin((1 - share) * v.angle) * v.inverse_sine;
        const double b = lerp ? share : std::sin(share * v.angle) * v.inverse_sine;
        p.rotation = glm::mat3_cast(v.from * a + v.to * b);
    }
    return p;
}

bool MotionPath::moves(double open_s, double close_s) const {
    if (!(close_s > open_s)) return false;
    if (intervals_.empty()) return false;
    const auto after = std::upper_bound(times_s_.begin() + 1, times_s_.end(), open_s);
    for (auto i = static_cast<std::size_t>(after - times_s_.begin()) - 1;
         i < intervals_.size() && times_s_[i] < close_s; ++i) {
        if (!intervals_[i].still()) return true;
    }
    return false;
}

std::vector<double> MotionPath::intervals(double open_s, double close_s) const {
    std::vector<double> out{open_s};
    for (const double t : times_s_) {
        if (t > open_s && t < close_s) out.push_back(t);
    }
    out.push_back(close_s);
    return out;
}

}  // namespace postlens
