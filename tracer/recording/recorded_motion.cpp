#include "tracer/recording/recorded_motion.h"

#include <map>
#include <set>

#include "scene/shape_bounds.h"

namespace postlens {
namespace {

// Sets the bounding sphere of a moving object from its bounding box, in m. The sphere is finite even if the
// box is infinite.
void bound(const Bounds& box, ObjectMotion& motion) {
    constexpr double farthest_m = 1e9;
    const glm::dvec3 low = glm::max(box.min, glm::dvec3(-farthest_m)),
                     high = glm::min(box.max, glm::dvec3(farthest_m));
    if (box.empty()) return;
    motion.centre_m = 0.5 * (low + high);
    motion.radius_m = 0.5 * glm::length(high - low);
}

}  // namespace

SceneMotion recorded_motion(const Scene& scene, const Camera& camera) {
    SceneMotion out;
    std::map<std::uint32_t, Bounds> boxes;
    for (const Object& o : scene.objects) {
        if (o.keys.empty()) continue;
        out.objects.try_emplace(o.id, ObjectMotion{.keys = o.keys});
        boxes[o.id].add(shape_bounds(o.shape, o.motion_base));
    }
    for (auto& [id, motion] : out.objects) bound(boxes[id], motion);
    out.camera = camera.keys;
    for (const Light& l : scene.lights) {
        if (l.keys.empty() && out.objects.empty()) continue;
        const bool directional = l.kind == Light::Kind::directional;
        out.lights.push_back({directional, directional ? l.direction : l.position, l.casts_shadows, l.keys});
    }
    return out;
}

std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene) {
    std::map<std::uint32_t, const Object*> first;
    std::set<std::uint32_t> apart;
    for (const Object& o : scene.objects) {
        const auto [of, added] = first.try_emplace(o.id, &o);
        if (!added && of->second->keys != o.keys) apart.insert(o.id);
    }
    return {apart.begin(), apart.end()};
}

}  // namespace postlens
