// Random keys and shapes for tests of motion. The same seed gives the same numbers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <vector>

#include "scene/scene.h"

namespace postlens::test {

struct RandomNumbers {
    std::mt19937_64 engine;
    explicit RandomNumbers(std::uint64_t seed) : engine(seed) {}

    double in(double low, double high) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    }
    glm::dvec3 in_box(double half) {
        const double x = in(-half, half), y = in(-half, half);
        return {x, y, in(-half, half)};
    }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 p = in_box(1);
            const double length = glm::length(p);
            if (length > 0.1 && length <= 1) return p / length;
        }
    }
    glm::dquat turn(double angle) { return glm::angleAxis(angle, direction()); }
};

/// How far a key may lie from the one before it.
struct RandomKeys {
    double way_m = 1.5, angle = 2.5;
    double scale_low = 0.6, scale_high = 1.6;
};

/// `times` grow.
inline std::vector<TransformKey> random_keys(RandomNumbers& random, const std::vector<double>& times,
                                             const RandomKeys& options = {}) {
    std::vector<TransformKey> keys;
    glm::dquat rotation = random.turn(random.in(0, 3));
    for (const double t : times) {
        TransformKey k;
        k.time_s = t;
        k.translation = random.in_box(options.way_m);
        rotation = glm::normalize(random.turn(random.in(0, options.angle)) * rotation);
        k.rotation = rotation;
        for (int c = 0; c < 3; ++c) k.scale[c] = random.in(options.scale_low, options.scale_high);
        keys.push_back(k);
    }
    return keys;
}

}  // namespace postlens::test
