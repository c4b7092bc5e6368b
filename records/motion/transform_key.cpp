#include "records/motion/transform_key.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

namespace postlens {
namespace {

glm::dmat4 matrix(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
    glm::dmat4 m = glm::mat4_cast(rotation);
    for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[axis];
    m[3] = glm::dvec4(translation, 1);
    return m;
}

glm::dmat4 matrix(const TransformKey& key) {
    return matrix(key.translation, key.rotation, key.scale);
}

}  // namespace

glm::dmat4 transform_at(const std::vector<TransformKey>& keys, double time_s) {
    if (keys.empty()) return glm::dmat4(1);
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const TransformKey& key) { return t < key.time_s; });
    if (after == keys.begin()) return matrix(keys.front());
    if (after == keys.end()) return matrix(keys.back());
    const TransformKey& a = *(after - 1);
    const TransformKey& b = *after;
    if (time_s == a.time_s) return matrix(a);  // return the key itself, without the rounding errors of slerp
    const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
    return matrix(glm::mix(a.translation, b.translation, share), glm::slerp(a.rotation, b.rotation, share),
                  glm::mix(a.scale, b.scale, share));
}

}  // namespace postlens
