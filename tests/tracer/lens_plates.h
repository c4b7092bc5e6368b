// Scenes of plates in front of a wall, and the surfaces that are recorded there for a lens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "records/record.h"
#include "records/record_check.h"
#include "tests/support/scene_builder.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/hidden_surfaces.h"
#include "tracer/shading_trees/lens_reach.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens::test {

/// The size of all images, px.
inline constexpr int width_px = 96, height_px = 64;
/// The radius of the aperture: f/0.5 at 50 mm, so that hidden strips are wide in a small image.
inline constexpr double radius_m = 0.05;
/// Film distance / pixel pitch, px.
inline constexpr double gain_px = width_px * 50.0 / 36.0;
/// The displacement per difference of inverse depths at the aperture's border, px m.
inline constexpr double gain_px_m = gain_px * radius_m;
inline constexpr double margin_px = LensReach::margin_px;

/// An empty scene with a camera of this image size.
inline SceneBuilder wide() {
    SceneBuilder b;
    b.scene.cameras[0].width = width_px;
    b.scene.cameras[0].height = height_px;
    return b;
}

/// The records of all corners with at most `count` hidden layers: all that are found, or those that are
/// recorded for the lens, without strips of up to `same_place_px`.
inline std::vector<Record> sampled(const Scene& scene, bool for_lens, int count, int levels = 1,
                                   double same_place_px = HiddenLayers::invisible_px) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras[0], scene.time_s);
    const WhittedSettings settings;
    const LensReach reach(rays, camera, radius_m, settings.max_depth, same_place_px, -16, width_px + 17, -16,
                          height_px + 17);
    const WhittedTracer tracer(rays, camera, settings, {count, nullptr, for_lens ? &reach : nullptr});
    std::vector<Record> out;
    (void)sample_corners(
        tracer, {0, width_px, 0, height_px}, {.levels = levels}, [&](const RecordBand& band) {
            for (int y = band.y_begin; y < band.y_end; ++y) {
                for (int x = band.x_begin; x < band.x_end; ++x) {
                    const std::size_t k = band.pixel(x, y);
                    const auto pixel = std::span(band.records)
                                           .subspan(band.offsets[k], band.offsets[k + 1] - band.offsets[k]);
                    EXPECT_EQ(problem_of_pixel(pixel, x, y, {true, true}), nullptr);
                }
            }
            out.insert(out.end(), band.records.begin(), band.records.end());
        });
    return out;
}

/// The records of all corners, with the hidden layers that are recorded for the lens.
inline std::vector<Record> chosen(const Scene& scene, int levels = 1) {
    return sampled(scene, true, HiddenLayers::most, levels);
}

/// Records by raster position (y, x) and layer.
using Places = std::map<std::pair<float, float>, std::map<std::uint32_t, std::vector<Record>>>;

inline Places places(const std::vector<Record>& records) {
    Places out;
    for (const Record& r : records) out[{r.y, r.x}][r.layer].push_back(r);
    return out;
}

/// Adds a red plate at depth z, m, whose right edge is at raster x = `edge_px`.
inline void add_plate(SceneBuilder& b, double z, double edge_px) {
    const double end = (edge_px - width_px / 2.0) / gain_px * z;
    b.add(Rectangle{{end - 40, -20, -z}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
}

/// Adds a green wall at depth z, m, which fills the image.
inline void add_wall(SceneBuilder& b, double z) {
    b.add(square({0, 0, -z}, {0, 0, 1}, 200), glowing({0, 1, 0}));
}

}  // namespace postlens::test
