// Hidden surfaces that a lens sees and the pinhole does not: closed forms, and the whole trace.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "core/job.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tests/tracer/lens_plates.h"
#include "tracer/shading_trees/lens_reach.h"
#include "tracer/trace.h"

namespace postlens::test::lens_layers_test {
namespace {

using glm::dvec3;

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
        EXPECT_GE(behind, height_px * std::floor(band));
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
    EXPECT_GE(shown, height_px * std::floor(of_wall));
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

TEST(LensLayers, NoStripThatIsTooNarrow) {
    for (const double strip_px : {1.5, 2.5}) {
        SceneBuilder b = wide();
        add_plate(b, 1, 60.3);
        add_wall(b, 1 / (1 - strip_px / gain_px_m));
        const auto has_hidden = [&](double same_place_px) {
            const std::vector<Record> records = sampled(b.scene, true, HiddenLayers::most, 1, same_place_px);
            return std::ranges::any_of(records, [](const Record& r) { return r.layer > 0; });
        };
        EXPECT_TRUE(has_hidden(HiddenLayers::invisible_px));
        EXPECT_EQ(has_hidden(2), strip_px > 2);
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
    return std::cos(turn) * (static_cast<double>(at.second) - width_px / 2.0) -
           std::sin(turn) * (static_cast<double>(at.first) - height_px / 2.0);
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
    EXPECT_GT(hair, height_px);
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
    EXPECT_GT(behind, 2 * height_px * std::floor(band));
}

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

// Without mirrors and glass, LensReach finds depths without shading trees.
TEST(LensLayers, AMirrorThatNoRayMeetsChangesNothing) {
    SceneBuilder b = wide();
    add_plate(b, 1, 60.3);
    b.add(Sphere{{-0.3, 0.1, -2.5}, 0.3}, matte({0.6, 0.5, 0.4}));
    b.add(Box{{-0.1, -0.3, -1.8}, {0.1, 0.1, -1.7}}, matte({0.2, 0.5, 0.4}));
    add_wall(b, 4);
    const std::vector<Record> plain = chosen(b.scene);
    EXPECT_TRUE(std::any_of(plain.begin(), plain.end(), [](const Record& r) { return r.layer > 1; }));
    b.add(square({0, 0, 10}, {0, 0, 1}, 1), mirror());
    EXPECT_EQ(chosen(b.scene), plain);
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
        t.camera.width = 192;
        t.camera.height = 108;
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
        const double share = pixels / (192.0 * 108.0);
        RecordProperty(name, std::to_string(share) + " " + std::to_string(with / without));
        // At 960 x 540 px the share is a fifth; relative to the strips, the margin is five times as wide
        // here.
        EXPECT_GT(share, 0.10) << name;
        EXPECT_LT(share, 0.35) << name;
        EXPECT_LT(with / without, 1.6) << name;
    }
}

}  // namespace
}  // namespace postlens::test::lens_layers_test
