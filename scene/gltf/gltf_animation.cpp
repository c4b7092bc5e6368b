#include "scene/gltf/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "core/text.h"
#include "records/motion/scene_limits.h"
#include "scene/sampled_motion.h"

namespace postlens {
namespace {

constexpr double latest_s = 1e9;

glm::dquat quaternion(const std::array<double, 4>& v) {
    return {v[3], v[0], v[1], v[2]};
}

std::array<double, 4> parts_of(const glm::dquat& q) {
    return {q.x, q.y, q.z, q.w};
}

// Normalises a quaternion. A quaternion of length 0 becomes the identity.
std::array<double, 4> unit(const std::array<double, 4>& v) {
    const glm::dquat q = quaternion(v);
    return glm::length(q) > 1e-12 ? parts_of(glm::normalize(q)) : std::array<double, 4>{0, 0, 0, 1};
}

class AnimationReader {
  public:
    AnimationReader(const GltfDocument& document, GltfAccessors& accessors, double unit, SceneNotes& notes)
        : d_(document), accessors_(accessors), unit_(unit), notes_(notes) {}

    std::map<std::size_t, GltfNodeCurves> read() {
        for (const JsonPlace& animation : d_.root().objects("animations")) {
            const auto samplers = animation.objects("samplers");
            for (const JsonPlace& channel : animation.objects("channels")) read_channel(channel, samplers);
        }
        return std::move(out_);
    }

  private:
    void read_channel(const JsonPlace& channel, const std::vector<JsonPlace>& samplers) {
        const std::size_t sampler = channel.required(channel.index("sampler", samplers.size()), "sampler");
        const JsonPlace target = channel.required(channel.object("target"), "target");
        const std::string path = target.required(target.text("path"), "path");
        const auto node = target.index("node", d_.count("nodes"));
        if (path == "weights") return notes_.add("the motion of morph targets is left out");
        if (path == "pointer")
            return notes_.add("the motion of something else than a node's place is left out");
        if (!node) return;
        std::optional<GltfCurve> GltfNodeCurves::*member = path == "translation"
                                                               ? &GltfNodeCurves::translation
                                                           : path == "rotation" ? &GltfNodeCurves::rotation
                                                           : path == "scale"    ? &GltfNodeCurves::scale
                                                                                : nullptr;
        if (!member) {
            target.fail_here("has an unknown path (got {}; expected translation, rotation, scale or weights)",
                             excerpt(path));
        }
        std::optional<GltfCurve>& curve = out_[*node].*member;
        if (curve) {
            return notes_.add("two animations move the same of a node: the first one counts");
        }
        curve = read_curve(samplers[sampler], path == "rotation" ? 4 : 3);
        if (path == "translation") {
            for (double& v : curve->values) v *= unit_;
        }
        check_range(target, *curve);
    }

    GltfCurve read_curve(const JsonPlace& sampler, std::size_t components) {
        GltfCurve curve;
        const std::string kind = sampler.text("interpolation").value_or("LINEAR");
        if (kind == "STEP") {
            curve.kind = GltfCurve::Kind::step;
        } else if (kind == "CUBICSPLINE") {
            curve.kind = GltfCurve::Kind::cubic_spline;
        } else if (kind != "LINEAR") {
            sampler.fail_here("has an unknown interpolation (got {}; expected LINEAR, STEP or CUBICSPLINE)",
                              excerpt(kind));
        }
        const std::size_t count = d_.count("accessors");
        const GltfValues times =
            accessors_.floats(sampler.required(sampler.index("input", count), "input"), {1}, sampler);
        curve.times_s.assign(times.values.begin(), times.values.end());
        for (std::size_t i = 0; i < curve.times_s.size(); ++i) {
            const double t = curve.times_s[i];
            if (std::abs(t) > latest_s || (i > 0 && !(t > curve.times_s[i - 1]))) {
                sampler.fail_here("has times that do not grow, or beyond {} s (got {} s as number {})",
                                  latest_s, t, i);
            }
        }
        const GltfValues values = accessors_.floats(
            sampler.required(sampler.index("output", count), "output"), {components}, sampler);
        const std::size_t per_key = curve.kind == GltfCurve::Kind::cubic_spline ? 3 : 1;
        if (values.count != per_key * times.count) {
            sampler.fail_here("has the wrong number of values (got {}; expected {})", values.count,
                              per_key * times.count);
        }
        curve.components = components;
        curve.values.assign(values.values.begin(), values.values.end());
        return curve;
    }

    static void check_range(const JsonPlace& target, const GltfCurve& curve) {
        for (const double v : curve.values) {
            if (!(std::abs(v) <= largest_length_m)) {
                target.fail_here("is moved out of range (got {}; expected at most {})", v, largest_length_m);
            }
        }
    }

    const GltfDocument& d_;
    GltfAccessors& accessors_;
    double unit_;
    SceneNotes& notes_;
    std::map<std::size_t, GltfNodeCurves> out_;
};

}  // namespace

std::array<double, 4> GltfCurve::at(double time_s) const {
    const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
    const bool cubic = kind == Kind::cubic_spline;
    // Returns the value of keyframe k. A cubic spline has three entries per keyframe, and `part` chooses one:
    // the incoming tangent (0), the value (1) or the outgoing tangent (2).
    const auto value = [&](std::size_t k, std::size_t part) {
        std::array<double, 4> v{};
        const std::size_t from = (cubic ? 3 * k + part : k) * components;
        for (std::size_t i = 0; i < components; ++i) v[i] = values[from + i];
        return v;
    };
    const auto finished = [&](const std::array<double, 4>& v) { return components == 4 ? unit(v) : v; };
    if (after == times_s.begin()) return finished(value(0, 1));
    const auto k = static_cast<std::size_t>(after - times_s.begin()) - 1;
    if (kind == Kind::step || after == times_s.end()) return finished(value(k, 1));
    const double gap = times_s[k + 1] - times_s[k], t = (time_s - times_s[k]) / gap;
    const auto a = value(k, 1), b = value(k + 1, 1);
    if (!cubic && components == 4) {
        return parts_of(glm::slerp(quaternion(unit(a)), quaternion(unit(b)), t));
    }
    std::array<double, 4> v{};
    if (!cubic) {
        for (std::size_t i = 0; i < components; ++i) v[i] = (1 - t) * a[i] + t * b[i];
        return v;
    }
    // Cubic Hermite interpolation. Tangents are slopes per second [gltf2, appendix C.4].
    const auto leaving = value(k, 2), arriving = value(k + 1, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < components; ++i) {
        v[i] = (2 * t3 - 3 * t2 + 1) * a[i] + gap * (t3 - 2 * t2 + t) * leaving[i] +
               (3 * t2 - 2 * t3) * b[i] + gap * (t3 - t2) * arriving[i];
    }
    return finished(v);
}

Placement GltfNodeCurves::at(double time_s, const Placement& own) const {
    Placement out = own;
    if (translation) {
        const auto v = translation->at(time_s);
        out.translation = {v[0], v[1], v[2]};
    }
    if (rotation) out.rotation = quaternion(rotation->at(time_s));
    if (scale) {
        const auto v = scale->at(time_s);
        out.scale = {v[0], v[1], v[2]};
    }
    return out;
}

std::vector<double> GltfNodeCurves::times_s() const {
    std::vector<double> out;
    for (const auto* curve : {&translation, &rotation, &scale}) {
        if (!*curve) continue;
        const std::vector<double>& times = (*curve)->times_s;
        out.insert(out.end(), times.begin(), times.end());
        if ((*curve)->kind != GltfCurve::Kind::step) continue;
        for (std::size_t i = 1; i < times.size(); ++i) {
            out.push_back(std::max(times[i] - shortest_key_gap_s, 0.5 * (times[i - 1] + times[i])));
        }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

std::map<std::size_t, GltfNodeCurves> read_gltf_animations(const GltfDocument& document,
                                                           GltfAccessors& accessors, double metres_per_unit,
                                                           SceneNotes& notes) {
    return AnimationReader(document, accessors, metres_per_unit, notes).read();
}

}  // namespace postlens
