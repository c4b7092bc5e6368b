// Shapes of all kinds in random motion, and rays towards them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "scene/scene.h"
#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tracer/intersection/motion_steps.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens::test {

/// The shutter interval of all scenes, s.
inline constexpr TimeSpan shutter{0.25, 1.25};
/// The time of a key inside the shutter interval. Neither floats nor equal steps hit this time exactly.
inline constexpr double kink_s = 0.25 + 0.3137;

/// A sphere as a mesh with vertex normals and uvs.
inline std::shared_ptr<const Mesh> smooth_ball(int rings, int sectors) {
    auto mesh = std::make_shared<Mesh>(*sphere_mesh(rings, sectors, true));
    for (const glm::vec3& p : mesh->positions) mesh->uvs.emplace_back(p.x, p.y * p.z);
    return mesh;
}

/// A shape; with `twice`, two objects share its mesh.
struct NamedShape {
    const char* name;
    Shape shape;
    bool mesh = false, twice = false;
};

/// All kinds of shapes. The mesh that two objects share is large enough to be shared in Embree.
inline std::vector<NamedShape> all_shapes() {
    return {{"sphere", Sphere{{0.1, 0, 0}, 0.8}},
            {"box", Box{{-0.8, -0.4, -0.3}, {0.9, 0.5, 0.4}}},
            {"disc", Disc{{0, 0, 0}, {0, 1, 2}, 1, 0.3}},
            {"rectangle", Rectangle{{-1, -0.5, 0}, {2, 0, 0}, {0, 1, 0.2}}},
            {"plane", Plane{{0, 0, 0}, {0.2, 0.1, 1}}},
            {"cone", Cone{{0, 0, -0.8}, {0, 0.1, 0.9}, 0.7, 0.2, true}},
            {"cylinder", Cone{{0, -0.9, 0}, {0, 0.9, 0}, 0.4, 0.4, false}},
            {"flat mesh", sphere_mesh(6, 8, false), true},
            {"smooth mesh", smooth_ball(6, 8), true},
            {"shared mesh", smooth_ball(12, 16), true, true}};
}

/// A textured material, because uvs and object positions are only computed for textured objects.
inline Material textured() {
    Material m = matte(glm::dvec3(1));
    m.colour_texture = std::make_shared<Texture>(Checker{});
    return m;
}

/// A kind of motion.
struct MotionKind {
    const char* name;
    bool uniform;       ///< the scale is uniform and constant
    std::size_t count;  ///< keys
};
inline constexpr MotionKind kinds[] = {{"rigid, two keys", true, 2},
                                       {"stretched, two keys", false, 2},
                                       {"rigid, a kink", true, 3},
                                       {"stretched, a kink", false, 3}};

/// Random keys around the shutter interval.
inline std::vector<TransformKey> keys_of(const MotionKind& kind, RandomNumbers& random) {
    RandomKeys options{0.8, 1.2, 0.7, 1.4};
    if (kind.uniform) options.scale_low = options.scale_high = 1;
    std::vector<double> times{0.1, 1.6};
    if (kind.count == 3) times = {0.1, kink_s, 1.6};
    return random_keys(random, times, options);
}

/// A shape in random motion inside a still ball, which is the last object.
inline SceneBuilder scene_of(const NamedShape& shape, const MotionKind& kind, RandomNumbers& random) {
    SceneBuilder b;
    const Material m = textured();
    Object& o = b.add(shape.shape, m);
    o.keys = keys_of(kind, random);
    o.motion_base = glm::translate(glm::dmat4(1), random.in_box(0.2));
    if (shape.twice) {
        Object& second = b.add(shape.shape, m);
        second.keys = keys_of(kind, random);
        for (TransformKey& k : second.keys) k.translation += glm::dvec3(2.5, 0, 0);
    }
    b.add(Sphere{{0, 0, 0}, 40}, matte(glm::dvec3(1)));  // a still background
    return b;
}

/// The tolerance of the motion of meshes, m.
inline constexpr double motion_m = 1e-4;

/// 0.05 px, which are `motion_m` everywhere.
inline MotionAccuracy accuracy() {
    return {[](const glm::dvec3&, double) { return 0.05 / motion_m; }, 0.05};
}

/// Rays of a batch, with their origins and directions in double.
struct Rays {
    RayBatch batch;
    std::vector<glm::dvec3> o, d;

    void add(const glm::dvec3& from, const glm::dvec3& to, double time) {
        // Origins and directions are rounded to float, so that the moving and the still scene have the same
        // ray.
        const glm::dvec3 start(glm::vec3{from}), direction(glm::vec3(glm::normalize(to - start)));
        o.push_back(start);
        d.push_back(glm::normalize(direction));
        batch.add(start, direction, std::numeric_limits<float>::infinity(), {}, static_cast<float>(time));
    }
};

/// Rays towards the object from random directions, aimed at its position at the time of the ray. Some rays
/// miss the object. Ray i has time times[i % times.size()], so that a packet has rays of many times.
inline Rays rays_at(const Scene& scene, const std::vector<double>& times, int per_time,
                    RandomNumbers& random) {
    Rays r;
    r.batch.clear(false, true);
    for (int i = 0; i < per_time; ++i) {
        for (const double time : times) {
            const Object& o = scene.objects[scene.objects.size() > 2 ? static_cast<std::size_t>(i % 2) : 0];
            const glm::dvec3 middle(transform_at(o.keys, shutter.at(time)) * o.motion_base *
                                    glm::dvec4(0, 0, 0, 1));
            const glm::dvec3 from = middle + 5.0 * random.direction();
            r.add(from, middle + random.in_box(0.8), time);
        }
    }
    return r;
}

/// The ends and the middle of the shutter interval, the key inside it with its neighbouring floats, and
/// `count` random times; 0 to 1 over the interval.
inline std::vector<double> times_of(const MotionKind& kind, RandomNumbers& random, int count) {
    std::vector<double> times{0, 1, 0.5};
    if (kind.count == 3) {
        const auto key = static_cast<float>((kink_s - shutter.open_s) / (shutter.close_s - shutter.open_s));
        for (const float t : {std::nextafter(key, 0.0F), key, std::nextafter(key, 1.0F)})
            times.push_back(static_cast<double>(t));
    }
    for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(static_cast<float>(random.in(0, 1))));
    return times;
}

}  // namespace postlens::test
