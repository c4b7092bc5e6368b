// A scene of one mesh, for benchmarks.
#pragma once

#include <cmath>
#include <memory>

#include "scene/scene.h"

namespace postlens {

/// A scene with a bumpy ball of `triangles` triangles that fills most of the frame.
inline Scene mesh_scene(int triangles) {
    auto mesh = std::make_shared<Mesh>();
    const int rings = static_cast<int>(std::sqrt(triangles / 4.0)), sectors = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        for (int k = 0; k <= sectors; ++k) {
            const double a = 3.14159265358979 * i / rings, b = 2 * 3.14159265358979 * k / sectors;
            const double r = 1 + 0.02 * std::sin(40 * a) * std::sin(40 * b);
            mesh->positions.emplace_back(r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b),
                                         r * std::cos(a));
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < sectors; ++k) {
            const auto p = static_cast<unsigned>(i * (sectors + 1) + k),
                       q = p + static_cast<unsigned>(sectors) + 1;
            mesh->triangles.emplace_back(p, q, p + 1);
            mesh->triangles.emplace_back(p + 1, q, q + 1);
        }
    }
    Scene scene;
    scene.name = "mesh";
    scene.materials.emplace_back();
    Object o;
    o.id = 1;
    o.shape = std::shared_ptr<const Mesh>(mesh);
    scene.objects.push_back(o);
    Camera c;
    c.position = {0, 0, 4};
    c.horizontal_fov_degrees = 45;
    scene.cameras.push_back(c);
    return scene;
}

}  // namespace postlens
