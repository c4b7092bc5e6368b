// A scene of a white floor, and the settings of a render through a pinhole.
#pragma once

#include <glm/glm.hpp>

#include "tests/support/scene_builder.h"
#include "tracer/render.h"

namespace postlens::test {

/// A white floor in the plane y = 0. The raster's x axis is parallel to the floor's x axis.
inline SceneBuilder floor_scene(int width = 24, int height = 2) {
    SceneBuilder b;
    Camera& c = b.scene.cameras[0];
    c.width = width;
    c.height = height;
    c.position = {-3, 2, 0};
    c.look_at = {0, 0, 0};
    c.up = {0, 0, -1};  // makes the two x axes parallel
    c.focal_length_mm = 100;
    b.add(Plane{{0, 0, 0}, {0, 1, 0}}, matte(glm::dvec3(1)));
    return b;
}

/// Settings of a render through a pinhole with `spp` samples per pixel.
inline RenderSettings pinhole(int spp) {
    RenderSettings s;
    s.spp = spp;
    return s;
}

}  // namespace postlens::test
