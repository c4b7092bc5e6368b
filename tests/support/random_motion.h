// Random numbers and motion keys. The same seed gives the same numbers on every platform.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <vector>

#include "scene/scene.h"

namespace postlens::test {

/// Random numbers, points and rotations of one seed.
struct RandomNumbers {
    std::mt19937_64 engine;
    explicit RandomNumbers(std::uint64_t seed) : engine(seed) {}

    /// A number in [low, high).
    double in(double low, double high) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    }
    /// A point in the cube [-half, half)^3.
    glm::dvec3 in_box(double half) {
        const double x = in(-half, half), y = in(-half, half);
        return {x, y, in(-half, half)};
    }
    /// A unit vector, uniform over the sphere.
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 p = in_box(1);
            const double length = glm::length(p);
            if (length > 0.1 && length <= 1) return p / length;
        }
    }
    /// A rotation by `angle`, rad, about a random axis.
    glm::dquat turn(double angle) { return glm::angleAxis(angle, direction()); }
};

/// The range of random keys.
struct RandomKeys {
    double way_m = 1.5;                        ///< largest coordinate of a translation
    double angle = 2.5;                        ///< largest rotation from one key to the next, rad
    double scale_low = 0.6, scale_high = 1.6;  ///< along each axis
};

/// Random keys at `times`, s, which must increase.
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
