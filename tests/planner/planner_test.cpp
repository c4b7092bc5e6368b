// Predictions of the planner against results: noise of views, density of records, whole images, and planned
// traces.
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "focus/responses/kernel.h"
#include "pictures/srgb.h"
#include "planner/auto_picture.h"
#include "planner/errors/edge_cells.h"
#include "planner/errors/record_floor.h"
#include "planner/trace_plan.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/motion_frame.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"

namespace postlens::test::planner_test {
namespace {

using glm::dvec3;

AutoSettings settings(double target_db, double focus_m = 3) {
    AutoSettings s;
    s.hybrid.focus = {.lens = wide, .focus_distance_m = focus_m};
    s.target_db = target_db;
    return s;
}

/// The noise of 1024 rays per pixel is at 59 dB or lower, measured for each scene here.
Image rays(const Scene& scene, const AutoSettings& a, int spp = 1024) {
    RenderSettings s;
    s.focal_length_mm = wide.focal_length_mm;
    s.f_number = wide.f_number;
    s.focus_m = a.hybrid.focus.focus_distance_m;
    s.spp = spp;
    return render_picture(scene, s).image;
}

TEST(RecordFloor, VarianceOfAnEdgeInASquare) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    constexpr int grid = 64;
    double sum = 0;
    int edges = 0;
    for (int i = 0; i < 4000; ++i) {
        const double angle = unit(random) * 6.283185307179586, nx = std::cos(angle), ny = std::sin(angle),
                     d = -1.5 + 4 * unit(random);
        const auto inside = [&](double x, double y) { return nx * x + ny * y <= d; };
        const int corners = inside(0, 0) + inside(1, 0) + inside(0, 1) + inside(1, 1);
        if (corners == 0 || corners == 4) continue;
        int covered = 0;
        for (int y = 0; y < grid; ++y) {
            for (int x = 0; x < grid; ++x) covered += inside((x + 0.5) / grid, (y + 0.5) / grid) ? 1 : 0;
        }
        const double e = static_cast<double>(covered) / (grid * grid) - corners / 4.0;
        sum += e * e;
        ++edges;
    }
    ASSERT_GT(edges, 1000);
    // The squared error of one edge is below 1/9. The mean of over 1000 deviates by less than
    // 0.0388 / sqrt(1000) * 2.
    EXPECT_NEAR(sum / edges, edge_cell_variance, 0.0025);
}

/// Light and centroid of a disc, either exact or as represented by cells.
struct Lamp {
    double light = 0, x = 0, y = 0;
};

/// The encoded image, 40 px wide, of a light that is spread over its circle of confusion.
std::vector<double> spread(const Lamp& lamp, double coc_px, double ground) {
    constexpr int edge = 40;
    std::vector<double> out(static_cast<std::size_t>(edge) * edge, ground);
    const int x0 = static_cast<int>(std::floor(lamp.x)), y0 = static_cast<int>(std::floor(lamp.y));
    const Kernel kernel =
        make_kernel(Ellipse::disc(coc_px / 2), lamp.x - x0, lamp.y - y0, {edge / 2, edge / 2});
    for (int y = kernel.y_begin; y < kernel.y_end(); ++y) {
        const KernelRow& row = kernel.rows[static_cast<std::size_t>(y - kernel.y_begin)];
        std::uint32_t tap = row.tap;
        for (int x = row.x_begin; x < row.x_end; ++x) {
            const bool inner = x >= row.inner_begin && x < row.inner_end;
            out[static_cast<std::size_t>(y + y0 + edge / 2) * edge +
                static_cast<std::size_t>(x + x0 + edge / 2)] +=
                lamp.light * static_cast<double>(inner ? kernel.inner : kernel.taps[tap++]);
        }
    }
    for (double& v : out) v = static_cast<double>(srgb_from_linear(static_cast<float>(v)));
    return out;
}

// Lights within a pixel of 16 cells, whose discs range from dim to far brighter than white.
TEST(SpreadLight, IsWhatKnowingALampByItsCornersErrsBy) {
    constexpr int cells = 4;
    constexpr double size = 1.0 / cells;
    const FocusGeometry geometry{.aperture_radius_m = 0.5, .inverse_focus_per_m = 0, .gain_px = 1, .zoom = 1};
    for (const double coc_px : {4.3, 9.1, 15.7}) {
        for (const double radiance : {5.0, 40.0, 300.0}) {
            std::mt19937 random(11);
            std::uniform_real_distribution<double> place(0.35, 0.65), radius(0.15, 0.33);
            double expected = 0, measured = 0;
            for (int i = 0; i < 200; ++i) {
                const double r = radius(random), x0 = place(random), y0 = place(random);
                std::array<CellCorner, (cells + 1) * (cells + 1)> corners{};
                for (std::size_t k = 0; k < corners.size(); ++k) {
                    const std::size_t column = k % (cells + 1), row = k / (cells + 1);
                    const double x = static_cast<double>(column) * size - x0,
                                 y = static_cast<double>(row) * size - y0;
                    corners[k].linear.fill(static_cast<float>(x * x + y * y < r * r ? radiance : 0.02));
                    for (float& e : corners[k].encoded) e = srgb_from_linear(corners[k].linear[0]);
                    corners[k].inverse_z = coc_px;
                }
                SpreadLight light;
                Lamp known;
                for (std::size_t k = 0; k < cells * cells; ++k) {
                    const std::size_t row = k / cells, column = k % cells, at = row * (cells + 1) + column;
                    const std::array<const CellCorner*, 4> of{
                        &corners[at], &corners[at + 1], &corners[at + cells + 1], &corners[at + cells + 2]};
                    light.add(of, cell_step(of), size, geometry);
                    double share = 0;
                    for (const CellCorner* c : of) share += c->linear[0] > 1 ? 0.25 : 0;
                    const double here = share * size * size * (radiance - 1);
                    known.light += here;
                    known.x += here * (static_cast<double>(column) + 0.5) * size;
                    known.y += here * (static_cast<double>(row) + 0.5) * size;
                }
                if (known.light == 0) continue;  // missed by all corners; floor_unseen covers this
                known.x /= known.light;
                known.y /= known.light;
                const std::vector<double> is = spread({3.14159 * r * r * (radiance - 1), x0, y0}, coc_px,
                                                      0.02),
                                          seen = spread(known, coc_px, 0.02);
                for (std::size_t k = 0; k < is.size(); ++k) measured += (is[k] - seen[k]) * (is[k] - seen[k]);
                expected += light.error();
            }
            // From dim discs to white discs, the prediction is within a factor of two.
            EXPECT_LT(std::abs(10 * std::log10(expected / measured)), 3)
                << coc_px << " px, radiance " << radiance << ": " << expected << " " << measured;
        }
    }
}

TEST(RecordFloor, IsWhatThePinholePictureErrsBy) {
    // Overlapping tilted boards with edges of all directions.
    SceneBuilder b;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    b.add(board(-30, 30, -30, 30, 12), glowing({0.5, 0.5, 0.5}));
    for (int i = 0; i < 40; ++i) {
        const double angle = 3.14159 * unit(random), size = 0.8 + 0.5 * unit(random);
        const dvec3 u(std::cos(angle) * size, std::sin(angle) * size, 0), v(-u.y, u.x, 0);
        b.add(Rectangle{dvec3(3.5 * unit(random), 2.6 * unit(random), -10 + 0.01 * i), u, v},
              glowing({0.5 + 0.5 * unit(random), 0.5 + 0.5 * unit(random), 0.5 + 0.5 * unit(random)}));
    }
    RenderSettings s;
    s.f_number = std::numeric_limits<double>::infinity();
    s.spp = 4096;
    const Image truth = render_picture(b.scene, s).image;
    for (const int levels : {0, 1, 2, 3}) {  // level 4 has as small an error as the 4096 rays
        const TracedFrame frame(b.scene, traced(false, levels));
        const std::vector<float> floor = record_floor(frame.file(), FocusGeometry{});
        double expected = 0;
        for (const float v : floor) expected += static_cast<double>(v) / static_cast<double>(floor.size());
        const double is = encoded_mse(pinhole_picture(frame.file()), truth);
        // The prediction ignores that radiances are averaged instead of encoded values, and corners with
        // three colours. It is within a factor of two, while errors of the levels differ by 24 dB.
        EXPECT_LT(std::abs(10 * std::log10(expected / is)), 3) << levels << ": " << expected << " " << is;
    }
}

TEST(AutoPicture, ReachesItsTargetAndStatesWhatItReached) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(true, 1));      // at most 30 dB without rays
    const Image truth = rays(b.scene, settings(45), 2048);  // 63 dB
    double views = 0;
    for (const double target : {25.0, 35.0, 45.0}) {
        AutoSettings s = settings(target);
        s.hybrid.scene = &b.scene;
        FocusFrame of(frame.file());
        const AutoResult r = auto_picture(of, s);
        const double is = encoded_psnr_db(r.hybrid.focus.image, truth);
        ASSERT_TRUE(r.hybrid.stated);
        EXPECT_TRUE(r.met) << r.plan;
        EXPECT_GE(r.hybrid.stated->db(), target);
        // With 64 x 48 px, few pieces determine the noise, so the interval is wide.
        EXPECT_GT(is, r.hybrid.stated->low_db()) << r.plan;
        EXPECT_LT(is, r.hybrid.stated->high_db()) << r.plan;
        EXPECT_GE(r.mean_views, views);
        views = r.mean_views;
    }
    EXPECT_GT(views, 32);
}

// Few pieces of the image have most of the error. With twice as many views in all tiles, the interval would
// be 4.7 dB wide.
TEST(AutoPicture, KnowsTheErrorIfItIsInFewPieces) {
    SceneBuilder b;
    b.add(board(-9, 9, -9, 9, 10), glowing({0.2, 0.25, 0.3}));
    b.add(board(-0.1, -0.05, -0.2, -0.1, 1), glowing({0.9, 0.8, 0.7}));
    for (int i = 0; i < 12; ++i)
        b.add(board(0.5 * i - 3, 0.5 * i - 2.8, -2.5, 2.5, 6), glowing({0.25, 0.3, 0.35}));
    b.scene.sha256 = std::string(64, 'a');
    b.scene.cameras[0].width = 256;
    b.scene.cameras[0].height = 192;
    const TracedFrame frame(b.scene, traced(true, 1));
    FocusFrame of(frame.file());
    AutoSettings s = settings(30);
    s.hybrid.scene = &b.scene;
    const AutoResult r = auto_picture(of, s);
    ASSERT_TRUE(r.hybrid.stated);
    EXPECT_LT(r.hybrid.stated->width_db(), 2.1) << r.plan;
}

TEST(AutoPicture, WithoutASceneItKnowsTheNoiseAndABound) {
    const SceneBuilder b = bar_and_wall();
    // The records are too coarse for 60 dB, and no surfaces behind the bar are recorded.
    const TracedFrame frame(b.scene, traced(false, 1));
    FocusFrame of(frame.file());
    AutoSettings s = settings(45, 10);
    const AutoResult r = auto_picture(of, s);
    EXPECT_FALSE(r.hybrid.stated);
    EXPECT_TRUE(r.met);
    ASSERT_FALSE(r.hybrid.focus.warnings.empty());
    EXPECT_EQ(r.hybrid.focus.warnings.back().code, "unsure");
    EXPECT_GE(r.noise_db(), 45);
    EXPECT_GT(r.unsure_share, 0.01);
    const Image truth = rays(b.scene, s);
    const double is = encoded_psnr_db(r.hybrid.focus.image, truth);
    EXPECT_GT(is, r.bound_db());
    EXPECT_LT(is, r.noise_db());
    // Without a target there is no warning.
    s.target_db.reset();
    EXPECT_TRUE(auto_picture(of, s).hybrid.focus.warnings.empty());
    // A target that the greatest number of views cannot reach.
    s.target_db = 80;
    const AutoResult most = auto_picture(of, s);
    EXPECT_FALSE(most.met);
    EXPECT_EQ(most.hybrid.focus.warnings.back().code, "target");
    // Rays show the surfaces that are not recorded.
    s = settings(45, 10);
    s.hybrid.scene = &b.scene;
    const AutoResult seen = auto_picture(of, s);
    EXPECT_TRUE(seen.met) << seen.plan;
    EXPECT_GT(seen.hybrid.retraced_share, 0.005);
    EXPECT_GT(encoded_psnr_db(seen.hybrid.focus.image, truth), is + 5);
}

TEST(AutoPicture, SameBitsForAnyNumberOfThreads) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(true));
    AutoSettings s = settings(36);
    s.hybrid.scene = &b.scene;
    const auto picture = [&](int threads) {
        const ThreadLimit limit(threads);
        FocusFrame of(frame.file(), true);
        return auto_picture(of, s).hybrid.focus.image.rgb;
    };
    const std::vector<float> one = picture(1);
    EXPECT_EQ(picture(2), one);
    EXPECT_EQ(picture(5), one);
}

TEST(AutoPicture, RefusesWhatIsOutOfRange) {
    const SceneBuilder b = bar_and_wall();
    const TracedFrame frame(b.scene, traced(false, 1));
    FocusFrame of(frame.file(), true);
    for (const double target : {9.0, 81.0, std::nan("")})
        EXPECT_THROW((void)auto_picture(of, settings(target)), Error) << target;
    AutoSettings s = settings(30);
    s.hybrid.focus.framing = Framing::lens;
    EXPECT_THROW((void)auto_picture(of, s), Error);
    s = settings(30);
    s.hybrid.focus.impulse.kind = ImpulseKind::diffraction;
    EXPECT_THROW((void)auto_picture(of, s), Error);
}

TEST(TracePlan, FindsTheLevelsThatATargetTakes) {
    SceneBuilder b = bar_and_wall();
    b.scene.cameras[0].width = 256;
    b.scene.cameras[0].height = 192;
    TraceSettings asked;
    asked.for_f_number = 2.8;
    asked.for_focus_m = 10;
    int before = -1;
    for (const double target : {25.0, 35.0, 45.0}) {
        const TracePlan p = plan_trace(b.scene, asked, target);
        EXPECT_TRUE(p.met);
        EXPECT_GE(p.floor_db, target + 3);
        EXPECT_GE(p.levels, before);
        before = p.levels;
        EXPECT_FALSE(p.settings.hidden_layers.has_value());

        const TemporaryFolder folder;
        const TraceResult r = trace_to_file(b.scene, p.settings, folder.path() / "frame.exr");
        // The preview pass covers 1/16 of the pixels, for which margins are relatively wider. The number of
        // records is predicted within a factor of two, that of bytes within three, as dense records compress
        // better.
        EXPECT_GT(p.records / static_cast<double>(r.records), 0.5) << target;
        EXPECT_LT(p.records / static_cast<double>(r.records), 2) << target;
        EXPECT_GT(p.bytes / static_cast<double>(r.bytes), 0.5) << target;
        EXPECT_LT(p.bytes / static_cast<double>(r.bytes), 3) << target;
        // The predicted error of the records equals that computed from the file.
        const SampleFileReader file(folder.path() / "frame.exr");
        const SampleHeader& h = file.header();
        const std::vector<float> floor =
            record_floor(file, focus_geometry({h.film_distance_mm, 2.8}, 10, Framing::keep,
                                              {h.film_distance_mm, h.pixel_pitch_mm}));
        double mean = 0;
        for (const float v : floor) mean += static_cast<double>(v) / static_cast<double>(floor.size());
        EXPECT_NEAR(-10 * std::log10(floor_unseen * mean), p.floor_db, 3) << target;
    }
    EXPECT_GT(before, 1);
}

TEST(TracePlan, CountsLampsThatAreSpread) {
    // The background is uniform, so only the lights have edges.
    SceneBuilder b;
    b.add(board(-9, 9, -9, 9, 10), glowing({0.2, 0.3, 0.4}));
    for (int i = 0; i < 8; ++i)
        b.add(board(-1.6 + 0.4 * i, -1.52 + 0.4 * i, -1 + 0.25 * i, -0.92 + 0.25 * i, 8),
              glowing({50, 50, 50}));
    b.scene.cameras[0].width = 512;
    b.scene.cameras[0].height = 384;
    TraceSettings asked;
    asked.for_f_number = wide.f_number;
    asked.for_focus_m = 3;
    const TemporaryFolder folder;
    for (const double target : {30.0, 38.0}) {
        const TracePlan p = plan_trace(b.scene, asked, target);
        trace_to_file(b.scene, p.settings, folder.path() / "frame.exr");
        const SampleFileReader file(folder.path() / "frame.exr");
        FocusFrame frame(file);
        const AutoResult r = auto_picture(frame, settings(target));
        EXPECT_GE(r.noise_db(), target) << r.plan;
    }
}

TEST(TracePlan, LeavesOutWhatIsNotNeeded) {
    SceneBuilder b = bar_and_wall();
    b.scene.cameras[0].width = 128;
    b.scene.cameras[0].height = 96;
    TraceSettings asked;
    asked.for_f_number = 512;
    asked.for_focus_m = 10;
    EXPECT_EQ(plan_trace(b.scene, asked, 30).settings.hidden_layers, 0);
    EXPECT_THROW((void)plan_trace(b.scene, {}, 30), Error);
    EXPECT_THROW((void)plan_trace(b.scene, asked, 5), Error);
    const TracePlan p = plan_trace(b.scene, asked, 80);
    EXPECT_FALSE(p.met);
    EXPECT_EQ(p.floors_db.size(), 7);
    const TracePlan for_rays = plan_trace(b.scene, asked, 80, true);
    EXPECT_TRUE(for_rays.met);
    EXPECT_EQ(for_rays.levels, TraceSettings::ray_levels);
    EXPECT_EQ(for_rays.floor_db, p.floors_db[TraceSettings::ray_levels]);
    EXPECT_LT(for_rays.records, p.records);
}

}  // namespace
}  // namespace postlens::test::planner_test
