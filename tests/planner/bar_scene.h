// A bar in front of a striped wall, and settings to trace, focus and render it.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "lens/thin_lens.h"
#include "pictures/image.h"
#include "planner/hybrid.h"
#include "tests/support/scene_builder.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test {

/// The lens of all images.
inline constexpr ThinLens wide{.focal_length_mm = 50, .f_number = 0.7};

/// A striped wall at 10 m, which is one object, and a bar at 1 m on the left.
inline SceneBuilder bar_and_wall() {
    SceneBuilder b;
    b.add(board(-0.34, -0.27, -2, 2, 1), glowing({0.9, 0.2, 0.1}));
    for (int i = -40; i < 40; ++i) {
        b.add(board(i * 0.35, i * 0.35 + 0.35, -9, 9, 10),
              glowing(i % 2 == 0 ? glm::dvec3(0.9, 0.9, 0.9) : glm::dvec3(0.15, 0.2, 0.4)))
            .id = 2;
    }
    b.scene.sha256 = std::string(64, 'a');
    return b;
}

/// Settings of a trace with or without the hidden surfaces that the lens sees past edges. No CoC has a larger
/// radius than the overscan if the focus is at 0.7 m or farther.
inline TraceSettings traced(bool hidden, int levels = 4) {
    TraceSettings s;
    s.subdivision.levels = levels;
    if (hidden) s.for_f_number = wide.f_number;
    s.overscan_px = 8;
    return s;
}

/// Settings of the hybrid method, focused at `focus_m`.
inline HybridSettings settings(double focus_m, int views = 256) {
    HybridSettings s;
    s.focus = {.lens = wide, .focus_distance_m = focus_m, .method = FocusMethod::hybrid, .views = views};
    return s;
}

/// Settings of a render by distributed rays through the same lens and shutter, `spp` per pixel.
inline RenderSettings by_rays(const HybridSettings& h, int spp = 1024, bool halves = false) {
    RenderSettings s;
    s.focal_length_mm = h.focus.lens.focal_length_mm;
    s.f_number = h.focus.lens.f_number;
    s.focus_m = h.focus.focus_distance_m;
    s.shutter = h.shutter;
    s.spp = spp;
    s.halves = halves;
    return s;
}

/// The image of these rays.
inline Image rays(const Scene& scene, const HybridSettings& h, int spp = 1024, bool halves = false) {
    return render_picture(scene, by_rays(h, spp, halves)).image;
}

}  // namespace postlens::test
