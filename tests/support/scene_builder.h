// Builds scenes in code: materials, objects and lights in front of a camera at the origin that looks along
// -z.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace postlens::test {

/// A diffuse material.
inline Material matte(const glm::dvec3& colour) {
    Material m;
    m.ambient = glm::dvec3(0);
    m.diffuse = colour;
    return m;
}

/// A black material that emits `radiance`.
inline Material glowing(const glm::dvec3& radiance) {
    Material m = matte(glm::dvec3(0));
    m.emission = radiance;
    return m;
}

/// A material that reflects this share of the light.
inline Material mirror(double reflection = 1) {
    Material m = matte(glm::dvec3(0));
    m.reflection = glm::dvec3(reflection);
    return m;
}

/// A material that transmits this share of the light and refracts it by `ior`.
inline Material glass(double ior, double transmission = 1) {
    Material m = matte(glm::dvec3(0));
    m.transmission = glm::dvec3(transmission);
    m.ior = ior;
    return m;
}

/// A rectangle that faces the camera, m.
inline Rectangle board(double x0, double x1, double y0, double y1, double depth_m) {
    return {glm::dvec3(x0, y0, -depth_m), glm::dvec3(x1 - x0, 0, 0), glm::dvec3(0, y1 - y0, 0)};
}

/// A scene with a camera of 64 x 48 px and 50 mm, without ambient light.
struct SceneBuilder {
    Scene scene;

    SceneBuilder() {
        scene.name = "test";
        scene.ambient_light = glm::dvec3(0);
        Camera c;
        c.focal_length_mm = 50;
        c.width = 64;
        c.height = 48;
        scene.cameras.push_back(c);
    }
    /// Adds an object. The ids of objects count from 1. The reference is valid until the next call.
    Object& add(Shape shape, const Material& material, const glm::dmat4& world_from_object = glm::dmat4(1)) {
        scene.materials.push_back(material);
        Object o;
        o.id = static_cast<std::uint32_t>(scene.objects.size() + 1);
        o.name = "object " + std::to_string(o.id);
        o.material = scene.materials.size() - 1;
        o.shape = std::move(shape);
        o.world_from_object = world_from_object;
        scene.objects.push_back(o);
        return scene.objects.back();
    }
    /// Adds a point light. The reference is valid until the next call.
    Light& point_light(const glm::dvec3& position, const glm::dvec3& intensity = glm::dvec3(1)) {
        Light l;
        l.position = position;
        l.intensity = intensity;
        scene.lights.push_back(l);
        return scene.lights.back();
    }
};

/// A square with sides of length `size` around `centre`, perpendicular to `normal`.
inline Rectangle square(const glm::dvec3& centre, const glm::dvec3& normal, double size) {
    const glm::dvec3 n = glm::normalize(normal);
    const glm::dvec3 hint = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(hint, n)) * size,
                     v = glm::normalize(glm::cross(n, u)) * size;
    return {centre - 0.5 * (u + v), u, v};
}

/// The unit sphere as a mesh; with exact vertex normals if `smooth`.
inline std::shared_ptr<const Mesh> sphere_mesh(int rings, int sectors, bool smooth) {
    auto mesh = std::make_shared<Mesh>();
    const double pi = 3.14159265358979323846;
    for (int i = 0; i <= rings; ++i) {
        for (int k = 0; k < sectors; ++k) {
            const double a = pi * i / rings, b = 2 * pi * k / sectors;
            mesh->positions.emplace_back(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
        }
    }
    if (smooth) mesh->normals = mesh->positions;
    const auto at = [&](int i, int k) { return static_cast<unsigned>(i * sectors + k % sectors); };
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < sectors; ++k) {
            if (i > 0) mesh->triangles.emplace_back(at(i, k), at(i + 1, k), at(i, k + 1));
            if (i + 1 < rings) mesh->triangles.emplace_back(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
        }
    }
    return mesh;
}

}  // namespace postlens::test
