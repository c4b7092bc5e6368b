// A scene, how it is recorded for a lens, and its images by hybrid and by rays: what the tests of view
// samples that become rays share.
#pragma once

#include <cstdint>
#include <string>

#include "compare/metrics/pixel_errors.h"
#include "planner/hybrid.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/render.h"

namespace postlens::test {

/// PSNR of encoded values, dB.
inline double db(const Image& image, const Image& truth) {
    return pixel_errors(Picture(image), Picture(truth), PixelMask(image.rgb.size() / 3, 1)).psnr_db;
}

struct Case {
    std::string scene;
    double f_number = 1.4, focus_m = 5;
};

inline Scene small(const std::string& name) {
    Scene scene = read_scene(std::string(POSTLENS_SAMPLES) + "/scenes/" + name);
    scene.cameras[0].width = 96;
    scene.cameras[0].height = 54;
    return scene;
}

inline TraceSettings traced_for(const Case& c) {
    TraceSettings s;
    s.for_f_number = c.f_number;
    s.for_focus_m = c.focus_m;
    return s;
}

inline HybridSettings hybrid_of(const Case& c, double focal_length_mm, int views) {
    HybridSettings s;
    s.focus = {.lens = {focal_length_mm, c.f_number}, .focus_distance_m = c.focus_m, .views = views};
    return s;
}

inline RenderSettings by_rays(const Case& c, double focal_length_mm, int spp, std::uint64_t seed,
                              bool halves = false) {
    RenderSettings s;
    s.focal_length_mm = focal_length_mm;
    s.f_number = c.f_number;
    s.focus_m = c.focus_m;
    s.spp = spp;
    s.seed = seed;
    s.halves = halves;
    return s;
}

inline Image rendered(const Scene& scene, const Case& c, double focal_length_mm, int spp, std::uint64_t seed,
                      bool halves = false) {
    return render_picture(scene, by_rays(c, focal_length_mm, spp, seed, halves)).image;
}

}  // namespace postlens::test
