#include "tracer/distributed/recentre.h"

namespace postlens {
namespace {

void move_keys(std::vector<TransformKey>& keys, const glm::dvec3& origin) {
    for (TransformKey& k : keys) k.translation -= origin;
}

}  // namespace

Scene recentred(Scene scene, const glm::dvec3& origin) {
    for (Object& o : scene.objects) {
        o.world_from_object[3] -= glm::dvec4(origin, 0);
        move_keys(o.keys, origin);
    }
    for (Light& l : scene.lights) {
        if (l.keys.empty()) l.position -= origin;
        move_keys(l.keys, origin);
    }
    for (Camera& c : scene.cameras) {
        if (c.keys.empty()) {
            c.position -= origin;
            c.look_at -= origin;
        }
        move_keys(c.keys, origin);
    }
    return scene;
}

}  // namespace postlens
