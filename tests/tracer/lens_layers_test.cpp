// Hidden surfaces that a lens sees and the pinhole does not, directly and in mirrors: those that `trace`
// records for an aperture are compared with closed forms and with rays from the lens.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "core/threads.h"
#include "records/record_check.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/lens_reach.h"
#include "tracer/trace.h"

namespace postlens::test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int width = 96, height = 64;
constexpr double radius_m = 0.05;                 // f/0.5 at 50 mm: wide strips in a small image
constexpr double gain_px = width * 50.0 / 36.0;   // film distance / pixel pitch
constexpr double gain_px_m = gain_px * radius_m;  // displacement per difference of inverse depths, px m
constexpr double margin_px = LensReach::margin_px;

SceneBuilder wide() {
    SceneBuilder b;
    b.scene.cameras[0].width = width;
    b.scene.cameras[0].height = height;
    return b;
}

struct Traced {
    std::vector<Record> all;     // every hidden surface
    std::vector<Record> chosen;  // those that are recorded for the lens
};
std::vector<Record> sampled(const Scene& scene, bool for_lens, int count, int levels = 1) {
    const RayScene rays(scene, scene.time_s);
    const CameraModel camera(scene.cameras[0], scene.time_s);
    const WhittedSettings settings;
    const LensReach reach(rays, camera, radius_m, settings.max_depth, -16, width + 17, -16, height + 17);
    const WhittedTracer tracer(rays, camera, settings, {count, nullptr, for_lens ? &reach : nullptr});
    std::vector<Record> out;
    (void)sample_corners(tracer, {0, width, 0, height}, {.levels = levels}, [&](const RecordBand& band) {
        for (int y = band.y_begin; y < band.y_end; ++y) {
            for (int x = band.x_begin; x < band.x_end; ++x) {
                const std::size_t k = band.pixel(x, y);
                const auto pixel =
                    std::span(band.records).subspan(band.offsets[k], band.offsets[k + 1] - band.offsets[k]);
                EXPECT_EQ(problem_of_pixel(pixel, x, y, {true, true}), nullptr);
            }
        }
        out.insert(out.end(), band.records.begin(), band.records.end());
    });
    return out;
}
std::vector<Record> chosen(const Scene& scene, int levels = 1) {
    return sampled(scene, true, HiddenLayers::most, levels);
}

// Per raster position and layer, the records.
using Places = std::map<std::pair<float, float>, std::map<std::uint32_t, std::vector<Record>>>;
Places places(const std::vector<Record>& records) {
    Places out;
    for (const Record& r : records) out[{r.y, r.x}][r.layer].push_back(r);
    return out;
}

// Adds a plate that ends at raster x = `edge_px`.
void add_plate(SceneBuilder& b, double z, double edge_px) {
    const double end = (edge_px - width / 2.0) / gain_px * z;
    b.add(Rectangle{{end - 40, -20, -z}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
}
void add_wall(SceneBuilder& b, double z) {
    b.add(square({0, 0, -z}, {0, 0, 1}, 200), glowing({0, 1, 0}));
}

TEST(LensLayers, BehindAPlateAsFarAsTheLensLooks) {
    for (const auto& [near, far] : {std::pair{1.0, 4.0}, {1.0, 50.0}, {2.0, 2.5}}) {
        SceneBuilder b = wide();
        add_plate(b, near, 60.3);
        add_wall(b, far);
        const double band = gain_px_m * (1 / near - 1 / far);
        int behind = 0;
        for (const auto& [at, layers] : places(chosen(b.scene))) {
            const double from_edge = 60.3 - static_cast<double>(at.second);
            if (from_edge <= 0 || from_edge > band + margin_px) {
                EXPECT_EQ(layers.size(), 1U) << from_edge << " px, band " << band;
            } else if (from_edge <= band) {
                ASSERT_TRUE(layers.contains(1)) << from_edge << " px, band " << band;
                EXPECT_EQ(layers.at(1).front().id, 2U);
                ++behind;
            }
            EXPECT_FALSE(layers.contains(2));
        }
        EXPECT_GE(behind, height * std::floor(band));
    }
}

TEST(LensLayers, GlassBehindAPlateAsFarAsWhatItShows) {
    // A transmitting sheet is displaced by 1.3 px against the plate's edge, the wall seen through it by over
    // 5 px.
    constexpr double near = 1, sheet = 1.25, far = 7.5;
    SceneBuilder b = wide();
    add_plate(b, near, 60.3);
    b.add(square({0, 0, -sheet}, {0, 0, 1}, 200), glass(1, 0.8));
    add_wall(b, far);
    const double of_sheet = gain_px_m * (1 / near - 1 / sheet), of_wall = gain_px_m * (1 / near - 1 / far);
    ASSERT_GT(of_wall, of_sheet + margin_px + 1);
    int shown = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        const double from_edge = 60.3 - static_cast<double>(at.second);
        if (from_edge > gain_px_m / near + margin_px) {
            EXPECT_EQ(layers.size(), 1U) << from_edge;
        } else if (from_edge > 0 && from_edge <= of_wall) {
            ASSERT_TRUE(layers.contains(1)) << from_edge << " px, of " << of_wall;
            EXPECT_TRUE(std::any_of(layers.at(1).begin(), layers.at(1).end(),
                                    [](const Record& r) { return r.path.text() == "T" && r.id == 3; }));
            ++shown;
        }
    }
    EXPECT_GE(shown, height * std::floor(of_wall));
}

TEST(LensLayers, NothingBehindWhatIsTooCloseOrHasNoEdge) {
    // The wall is displaced by only 0.2 px.
    SceneBuilder close = wide();
    add_plate(close, 1, 60.3);
    add_wall(close, 1 / (1 - 0.2 / gain_px_m));
    // A plane at 45 degrees, and walls behind it.
    SceneBuilder slope = wide();
    slope.add(square({0, 0, -2}, {0, 1, 1}, 50), glowing({1, 0, 0}));
    add_wall(slope, 8);
    // A floor up to the horizon, without an edge.
    SceneBuilder floor = wide();
    floor.add(Plane{{0, -1, 0}, {0, 1, 0}}, glowing({1, 0, 0}));
    for (const SceneBuilder* b : {&close, &slope, &floor}) {
        int hidden = 0;
        for (const Record& r : chosen(b->scene)) hidden += r.layer > 0 ? 1 : 0;
        EXPECT_EQ(hidden, 0);
    }
}

// A rectangle at z that fills columns [begin, end) px of a raster rotated by 0.1 rad about its centre, so
// that its edges cross rows and columns of corners.
constexpr double turn = 0.1;
void add_turned(SceneBuilder& b, double z, double begin_px, double end_px) {
    const dvec3 u{std::cos(turn), std::sin(turn), 0}, v{-std::sin(turn), std::cos(turn), 0};
    const double px = z / gain_px;
    b.add(Rectangle{begin_px * px * u - 20.0 * v - dvec3(0, 0, z), (end_px - begin_px) * px * u, 40.0 * v},
          glowing({1, 0, 0}));
}
double turned_x(const std::pair<float, float>& at) {
    return std::cos(turn) * (static_cast<double>(at.second) - width / 2.0) -
           std::sin(turn) * (static_cast<double>(at.first) - height / 2.0);
}

TEST(LensLayers, AThinHairHidesNothing) {
    // The hair is half a pixel wide. Wherever a corner hits it, the wall behind must be recorded.
    SceneBuilder b = wide();
    add_turned(b, 1, 3.1, 3.6);
    add_wall(b, 4);
    int hair = 0;
    for (const auto& [at, layers] : places(chosen(b.scene, 3))) {
        if (layers.at(0).front().id != 1) {
            EXPECT_EQ(layers.size(), 1U);
            continue;
        }
        ++hair;
        ASSERT_TRUE(layers.contains(1)) << at.second << ' ' << at.first;
        EXPECT_EQ(layers.at(1).front().id, 2U);
    }
    EXPECT_GT(hair, height);
}

TEST(LensLayers, ASlitIsSeenThrough) {
    // Between two plates is a gap of half a pixel, in which every other row has a corner. The wall must be
    // recorded behind both edges.
    SceneBuilder b = wide();
    add_turned(b, 1, -400, 3.1);
    add_turned(b, 1, 3.6, 400);
    add_wall(b, 4);
    const double band = gain_px_m * (1 - 1 / 4.0);
    int behind = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        const double from_gap = std::max(3.1 - turned_x(at), turned_x(at) - 3.6);
        if (from_gap > 0.01 && from_gap <= band) {
            EXPECT_TRUE(layers.contains(1)) << from_gap;
            ++behind;
        } else if (from_gap < -0.01 || from_gap > band + margin_px) {
            EXPECT_FALSE(layers.contains(1)) << from_gap;
        }
    }
    EXPECT_GT(behind, 2 * height * std::floor(band));
}

// Against rays ---------------------------------------------------------------------------------------

// Whether a ray from a point on the lens's rim, or on a ring inside it, hits the given surface point first.
bool seen_from_lens(const RayScene& rays, const CameraModel& camera, const dvec3& point) {
    RayBatch batch;
    batch.clear(false);
    std::vector<double> reach;
    for (int i = 0; i < 48; ++i) {
        const double a = 2 * 3.14159265358979 * (i % 24) / 24, r = radius_m * (i < 24 ? 0.999 : 0.6);
        const dvec3 from = camera.position + r * (std::cos(a) * camera.right + std::sin(a) * camera.down);
        reach.push_back(glm::length(point - from));
        batch.add(from, (point - from) / reach.back(), std::numeric_limits<float>::infinity());
    }
    rays.intersect(batch, false);
    for (std::size_t i = 0; i < reach.size(); ++i) {
        if (batch.hit(i).valid() && std::abs(static_cast<double>(batch.t[i]) - reach[i]) < 1e-3 * reach[i])
            return true;
    }
    return false;
}

// Checks that every hidden surface that rays from the lens find is recorded for the lens. Counts the recorded
// surfaces, and those of them that rays find.
struct Tally {
    int chosen = 0, seen = 0;
};
Tally expect_all_seen_chosen(const Scene& scene) {
    const RayScene rays(scene, 0);
    const CameraModel camera(scene.cameras[0], 0);
    const Places all = places(sampled(scene, false, HiddenLayers::most)), some = places(chosen(scene));
    Tally tally;
    int missed = 0;
    for (const auto& [at, layers] : some) {
        const auto known = all.find(at);
        if (known == all.end()) continue;  // sampled only because of edges of other hidden surfaces
        for (const auto& [layer, nodes] : known->second) {
            if (layer == 0) continue;
            const Record& r = nodes.front();
            const CameraRay eye = camera.ray(static_cast<double>(at.second), static_cast<double>(at.first));
            const bool is_chosen = layers.contains(layer);
            tally.chosen += is_chosen ? 1 : 0;
            if (r.id == 0) continue;
            const dvec3 point = eye.origin + eye.direction * (static_cast<double>(r.z) / eye.cos_axis);
            if (!seen_from_lens(rays, camera, point)) continue;
            ++tally.seen;
            if (is_chosen) continue;
            ++missed;
            // A missed surface behind one other must have a displacement that is not visible. Behind several
            // surfaces, the edge of one may be hidden by another one; this is rare and accepted.
            const double part = gain_px_m * std::abs(1 / static_cast<double>(layers.at(0).front().z) -
                                                     1 / static_cast<double>(r.z));
            if (layer == 1) {
                EXPECT_LT(part, LensReach::same_place_px) << at.second << ' ' << at.first;
            }
        }
    }
    EXPECT_LE(missed, tally.seen / 50);
    return tally;
}

TEST(LensLayersAgainstRays, PlatesBehindPlates) {
    SceneBuilder b = wide();
    add_plate(b, 1, 40.3);
    add_plate(b, 2, 38.6);  // its edge is hidden behind the first
    add_plate(b, 3, 44.8);  // extends beyond the first two
    add_wall(b, 9);
    const Tally t = expect_all_seen_chosen(b.scene);
    EXPECT_GT(t.seen, 1000);
    // Three layers in a strip of at most 6.4 px, each with its margin.
    EXPECT_LT(t.chosen, 2.2 * t.seen);
}

TEST(LensLayersAgainstRays, BallsAndBoxes) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int scene = 0; scene < 3; ++scene) {
        SceneBuilder b = wide();
        for (int i = 0; i < 6; ++i) {
            const double z = 1.2 + 0.6 * i;
            const dvec3 at{0.25 * z * any(random), 0.18 * z * any(random), -z};
            if (i % 2 == 0) {
                b.add(Sphere{at, 0.08 * z}, glowing({1, 0, 0}));
            } else {
                b.add(Box{at - 0.05 * z, at + 0.05 * z}, glowing({0, 0, 1}));
            }
        }
        b.add(Plane{{0, -1, 0}, {0, 1, 0}}, glowing({0.5, 0.5, 0}));
        add_wall(b, 9);
        const Tally t = expect_all_seen_chosen(b.scene);
        EXPECT_GT(t.seen, 500);
        EXPECT_LT(t.chosen, 3 * t.seen);
    }
}

// In mirrors and glass -------------------------------------------------------------------------------

TEST(LensLayersInMirrors, AFlatMirrorShowsWhatStandsBehindIt) {
    // A plate at 5 m and a wall at 8 m, seen directly and in a mirror at 2 m.
    const double edge_px = 50.3;
    SceneBuilder direct = wide();
    add_plate(direct, 5, edge_px);
    add_wall(direct, 8);
    SceneBuilder mirrored = wide();
    const double end = (edge_px - width / 2.0) / gain_px * 5;
    mirrored.add(Rectangle{{end - 40, -20, 1}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
    mirrored.add(square({0, 0, 4}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    mirrored.add(square({0, 0, -2}, {0, 0, 1}, 100), mirror(0.5));
    const Places a = places(chosen(direct.scene)), b = places(chosen(mirrored.scene));
    int behind = 0;
    for (const auto& [at, layers] : b) {
        ASSERT_TRUE(layers.at(0).front().path.bits() == 0);
        const auto there = a.find(at);
        if (there == a.end()) continue;
        ASSERT_EQ(layers.contains(1), there->second.contains(1)) << at.second << ' ' << at.first;
        if (!layers.contains(1)) continue;
        ++behind;
        ASSERT_EQ(layers.at(1).size(), 1U);
        const Record& r = layers.at(1).front();
        EXPECT_EQ(r.path.text(), "R");
        EXPECT_EQ(r.id, 2U);
        EXPECT_EQ(r.g, 0.5F);
        EXPECT_FLOAT_EQ(r.z, 8);
        EXPECT_NEAR(r.w.xx, 1 / 8.0, 1e-6);
        EXPECT_NEAR(r.w.yx, 0, 1e-6);
    }
    EXPECT_GT(behind, 2 * height);
}

TEST(LensLayersInMirrors, LayersComeAfterThoseOfThePrimary) {
    // The mirror ends in front of a wall, at the same raster position as the plate that it shows.
    SceneBuilder b = wide();
    const double end = (50.3 - width / 2.0) / gain_px;
    b.add(Rectangle{{end * 5 - 40, -20, 1}, {40, 0, 0}, {0, 40, 0}}, glowing({1, 0, 0}));
    b.add(square({0, 0, 4}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    b.add(Rectangle{{(end + 3 / gain_px) * 2 - 40, -20, -2}, {40, 0, 0}, {0, 40, 0}}, mirror(0.5));
    b.add(square({0, 0, -6}, {0, 0, 1}, 100), matte({0.5, 0.5, 0.5}));
    int both = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        std::uint32_t last_primary = 0;
        for (const auto& [layer, nodes] : layers) {
            if (nodes.front().path.bits() == 0) {
                last_primary = layer;
            } else {
                ++both;
                EXPECT_GT(layer, last_primary);
                // A layer is one subtree: all its paths begin with the path of the root.
                const NodePath root = nodes.front().path;
                for (const Record& r : nodes) {
                    EXPECT_EQ(r.path.bits() & ((1U << (2 * root.depth())) - 1), root.bits());
                }
            }
        }
    }
    EXPECT_GT(both, height);
}

TEST(LensLayersInMirrors, BehindGlass) {
    // A pane in front of a bar in front of a wall: the strip hidden by the bar is seen through the pane.
    SceneBuilder b = wide();
    b.add(Box{{-5, -5, -1.02}, {5, 5, -1}}, glass(1.5));
    b.add(Box{{-0.05, -5, -2.1}, {0.05, 5, -2}}, glowing({1, 0, 0}));
    add_wall(b, 8);
    int behind = 0, bar = 0;
    for (const auto& [at, layers] : places(chosen(b.scene))) {
        for (const Record& r : layers.at(0)) bar += r.path.text() == "TT" && r.id == 2 ? 1 : 0;
        for (const auto& [layer, nodes] : layers) {
            if (layer > 0 && nodes.front().path.text() == "TT" && nodes.front().id == 3) ++behind;
        }
    }
    // The bar is 6.7 px wide, less than the strips at its two edges, so the wall is recorded behind all of
    // it.
    EXPECT_GT(bar, 6 * height);
    EXPECT_EQ(behind, bar);
}

// The whole trace ------------------------------------------------------------------------------------

SceneBuilder busy() {
    SceneBuilder b = wide();
    Material shiny = matte({0.6, 0.5, 0.4});
    shiny.reflection = dvec3(0.3);
    add_wall(b, 6);
    b.add(Sphere{{-0.3, 0.1, -2.5}, 0.3}, shiny);
    b.add(Sphere{{0.4, 0.1, -1.4}, 0.2}, glass(1.5, 0.9));
    b.add(Plane{{0, -0.3, 0}, {0, 1, 0}}, shiny);
    b.add(Box{{-0.1, -0.3, -1.8}, {0.1, 0.1, -1.7}}, shiny);
    b.point_light({2, 3, 0});
    return b;
}

TEST(LensLayers, TheVisibleLayerHasTheSameBits) {
    const SceneBuilder b = busy();
    const std::vector<Record> bare = sampled(b.scene, false, 0);
    std::vector<Record> with = chosen(b.scene);
    EXPECT_GT(with.size(), bare.size());
    // Edges of hidden surfaces add samples. Samples that also exist without hidden layers are unchanged.
    std::erase_if(with, [](const Record& r) { return r.layer != 0; });
    auto at = with.begin();
    for (const Record& r : bare) {
        at = std::find(at, with.end(), r);
        ASSERT_NE(at, with.end()) << r.x << ", " << r.y;
    }
}

TEST(LensLayers, SameBitsForAnyNumberOfThreads) {
    const SceneBuilder b = busy();
    std::vector<Record> first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        const std::vector<Record> got = chosen(b.scene);
        if (first.empty()) first = got;
        EXPECT_EQ(got, first) << threads;
    }
    EXPECT_TRUE(std::any_of(first.begin(), first.end(),
                            [](const Record& r) { return r.layer > 0 && r.path.bits() != 0; }));
}

// Tests the share of pixels with hidden surfaces, and the ratio of the numbers of records with and without
// them.
TEST(LensLayers, CostWhatTheBandsAreWide) {
    for (const char* name : {"bars", "still_life"}) {
        const Scene scene = read_scene(std::string(POSTLENS_SAMPLES) + "/scenes/" + name + ".toml", {});
        const TemporaryFolder folder;
        TraceSettings t;
        t.camera.width = 320;
        t.camera.height = 180;
        t.for_f_number = 1.4;
        const double with = static_cast<double>(trace_to_file(scene, t, folder.path() / "a.exr").records);
        const SampleFileReader file(folder.path() / "a.exr");
        RecordBand band;
        file.read(file.y_begin(), file.y_end(), band);
        int pixels = 0;
        for (std::size_t k = 0; k + 1 < band.offsets.size(); ++k) {
            const auto first = band.records.begin() + band.offsets[k],
                       last = band.records.begin() + band.offsets[k + 1];
            pixels += std::any_of(first, last, [](const Record& r) { return r.layer > 0; }) ? 1 : 0;
        }
        t.hidden_layers = 0;
        const double without = static_cast<double>(trace_to_file(scene, t, folder.path() / "b.exr").records);
        const double share = pixels / (320.0 * 180.0);
        RecordProperty(name, std::to_string(share) + " " + std::to_string(with / without));
        // At 960 x 540 px the share is a fifth; relative to the strips, the margin is three times as wide
        // here.
        EXPECT_GT(share, 0.10) << name;
        EXPECT_LT(share, 0.35) << name;
        EXPECT_LT(with / without, 1.6) << name;
    }
}

}  // namespace
}  // namespace postlens::test
