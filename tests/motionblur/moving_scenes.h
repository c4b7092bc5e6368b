// Scenes that move: a bar, whose blurred image has a closed form, and plates before a wall.
#pragma once

#include <algorithm>
#include <cstring>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "tests/support/motion_frame.h"

namespace postlens::test {

inline constexpr double depth_m = 4;
inline constexpr double m_per_px = depth_m / px_per_m;

// A bar of radiance 1 on black, with its left edge at column `left`, `width` px wide and over the whole
// height. It moves by `way` px to the right.
inline Scene bar(double left, double width, double way, std::vector<TransformKey> keys = {}) {
    SceneBuilder b;
    Object& o =
        b.add(Rectangle{{(left - 32) * m_per_px, -10, -depth_m}, {width * m_per_px, 0, 0}, {0, 20, 0}},
              glowing(glm::dvec3(1)));
    o.keys = keys.empty() ? from_to({way * m_per_px, 0, 0}) : std::move(keys);
    return b.scene;
}

// The fraction of the exposure during which the bar covers x, for a box shutter and constant speed.
inline double trapezoid(double x, double left, double width, double way) {
    const auto integral = [&](double edge) {  // fraction of the time in which the edge is left of x
        return way == 0 ? (x >= edge ? 1.0 : 0.0) : std::clamp((x - edge) / way, 0.0, 1.0);
    };
    return integral(left) - integral(left + width);
}

inline double pixel_mean(int x, double left, double width, double way) {
    double sum = 0;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i) sum += trapezoid(x + (i + 0.5) / steps, left, width, way);
    return sum / steps;
}

// A plate over a chequered wall: what it uncovers is recorded with the shutter named, else filled.
inline Scene plate_over_wall() {
    SceneBuilder b;
    for (int i = -6; i < 6; ++i) {
        const double shade = i % 2 == 0 ? 0.8 : 0.1;
        b.add(Rectangle{{i * 0.4, -2, -6}, {0.4, 0, 0}, {0, 4, 0}}, glowing(glm::dvec3(shade)));
    }
    b.add(Rectangle{{-0.6, -0.5, -4}, {0.8, 0, 0}, {0, 1, 0}}, glowing({0.2, 0.9, 0.3})).keys =
        from_to({20 * m_per_px, 0, 0});
    return b.scene;
}

// A plate that moves parallel to the film close to a wall. Light falls on both.
inline SceneBuilder lit_plate() {
    SceneBuilder b;
    b.add(Rectangle{{-5, -4, -6}, {10, 0, 0}, {0, 8, 0}}, matte(glm::dvec3(0.8)));
    b.add(Rectangle{{-0.8, -0.5, -5}, {0.8, 0, 0}, {0, 1, 0}}, matte(glm::dvec3(0.7))).keys =
        from_to({20 * m_per_px, 0, 0});
    b.point_light({0.3, 1.5, -3.5});
    return b;
}

inline bool equal_bits(const Image& a, const Image& b) {
    return a.rgb.size() == b.rgb.size() &&
           std::memcmp(a.rgb.data(), b.rgb.data(), a.rgb.size() * sizeof(float)) == 0;
}

}  // namespace postlens::test
