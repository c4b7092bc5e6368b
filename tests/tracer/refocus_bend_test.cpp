// Nonlinear W (`w_bend`), the error of W: against exact rays from the lens, against closed forms for flat
// mirrors, and the warning of `focus`.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/threads.h"
#include "focus/bend_warning.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/bend_around.h"
#include "tracer/shading_trees/whitted.h"
#include "tracer/trace.h"

namespace postlens::test::refocus_bend_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double tangent_per_px = 36.0 / 50 / 64;  // of SceneBuilder's camera

std::vector<Record> trace_at(const Scene& scene, dvec2 at, double radius_m, const HiddenLayers& hidden = {}) {
    const RayScene rays(scene, 0);
    const CameraModel camera(scene.cameras.at(0), 0);
    TracedSamples traced;
    RayCounts counts;
    WhittedTracer(rays, camera, {.min_contribution = 0, .bend_radius_m = radius_m}, hidden)
        .trace(std::vector<dvec2>{at}, traced, counts);
    return traced.records;
}
const Record& node(const std::vector<Record>& records, const std::string& path) {
    const auto found =
        std::find_if(records.begin(), records.end(), [&](const Record& r) { return r.path.text() == path; });
    if (found == records.end()) throw std::runtime_error("no node " + path);
    return *found;
}

TEST(Bend, IsNothingForWhatIsSeenDirectlyAndInFlatMirrors) {
    SceneBuilder b;
    b.add(square({0, 0, -3}, glm::normalize(dvec3(1, 0, 1)), 3), mirror(0.8));
    b.add(square({4, 0, -3}, glm::normalize(dvec3(-1, 0, 0.2)), 6), mirror(0.8));
    b.add(square({0, 0, 6}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    int deeper = 0;
    for (const dvec2 at : {dvec2(32, 24), dvec2(20.5, 30.25), dvec2(40, 10)}) {
        for (const Record& r : trace_at(b.scene, at, 0.02)) {
            EXPECT_EQ(r.w_bend, 0) << r.path.text();
            deeper += r.path.depth() > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(deeper, 3);
}

// A ball mirror that shows a wall behind the camera.
SceneBuilder ball_mirror() {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -2}, 0.5}, mirror(0.9));
    b.add(square({0, 0, 3}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    return b;
}

// The point of the wall at z = 3 that a ray from lens point q with tangent p hits after reflection at the
// ball, by its formula.
dvec2 on_wall(dvec2 q, dvec2 p) {
    const dvec3 o{q.x, -q.y, 0}, d = glm::normalize(dvec3(p.x, -p.y, -1)), c{0, 0, -2};
    const double half = glm::dot(d, c - o);
    const double t = half - std::sqrt(half * half - glm::dot(c - o, c - o) + 0.25);
    const dvec3 x = o + t * d, n = (x - c) / 0.5, r = d - 2 * glm::dot(d, n) * n;
    const double s = (3 - x.z) / r.z;
    return {x.x + s * r.x, x.y + s * r.y};
}

// The largest departure from p - W q. W is found by differences, the exact tangent by Newton's method with
// differences.
double departure(dvec2 p0, double radius_m) {
    constexpr double h = 1e-6;
    const dvec2 target = on_wall({0, 0}, p0);
    const auto jacobian = [&](dvec2 q, dvec2 p) {
        return glm::dmat2((on_wall(q, p + dvec2(h, 0)) - on_wall(q, p - dvec2(h, 0))) / (2 * h),
                          (on_wall(q, p + dvec2(0, h)) - on_wall(q, p - dvec2(0, h))) / (2 * h));
    };
    const glm::dmat2 by_p = jacobian({0, 0}, p0);
    const glm::dmat2 by_q((on_wall({h, 0}, p0) - on_wall({-h, 0}, p0)) / (2 * h),
                          (on_wall({0, h}, p0) - on_wall({0, -h}, p0)) / (2 * h));
    const glm::dmat2 w = glm::inverse(by_p) * by_q;
    double worst = 0;
    for (const dvec2 q : {dvec2(radius_m, 0), dvec2(-radius_m, 0), dvec2(0, radius_m), dvec2(0, -radius_m)}) {
        dvec2 p = p0 - w * q;
        for (int i = 0; i < 20; ++i) p -= glm::inverse(jacobian(q, p)) * (on_wall(q, p) - target);
        worst = std::max(worst, glm::length(p - (p0 - w * q)));
    }
    return worst;
}

TEST(Bend, OfABallMirrorAgreesWithExactRays) {
    const SceneBuilder b = ball_mirror();
    for (const dvec2 at : {dvec2(40, 24), dvec2(44.5, 30), dvec2(25, 14), dvec2(32, 40)}) {
        const dvec2 p = (at - dvec2(32, 24)) * tangent_per_px;
        for (const double radius_m : {0.018, 0.009}) {
            const double got = static_cast<double>(node(trace_at(b.scene, at, radius_m), "R").w_bend);
            const double expected = departure(p, radius_m) / (radius_m * radius_m);
            // Tolerance: half floats, W rounded to float, and the residual of the last step, which is 5 %, or
            // less than a fifth of a step of 0.1 px.
            const double tolerance = 0.05 * expected + 0.02 * tangent_per_px / (radius_m * radius_m);
            EXPECT_NEAR(got, expected, tolerance) << at.x << ' ' << at.y << ", R " << radius_m;
            EXPECT_GT(got, 0);
        }
    }
}

TEST(Bend, IsOfSecondOrder) {
    // w_bend is the same for half of the aperture, whose error is a quarter.
    for (const dvec2 at : {dvec2(44.5, 30), dvec2(25, 14)}) {
        const dvec2 p = (at - dvec2(32, 24)) * tangent_per_px;
        const double whole = departure(p, 0.018), half = departure(p, 0.009);
        EXPECT_NEAR(whole / half, 4, 0.5);  // the third order is a tenth here
        const SceneBuilder b = ball_mirror();
        const auto bend = [&](double r) {
            return static_cast<double>(node(trace_at(b.scene, at, r), "R").w_bend);
        };
        EXPECT_NEAR(bend(0.009) / bend(0.018), 1, 0.25);
    }
}

TEST(Bend, IsOfThePointsOfTheLensThatSeeIt) {
    // A post in front of a curved mirror blocks the view of half of the lens beside it. This occlusion must
    // not count as an error of W.
    SceneBuilder shade = ball_mirror();
    const float open = node(trace_at(shade.scene, {32.5, 24}, 0.02), "R").w_bend;
    shade.add(Box{{-1, -1, -1.02}, {0, 1, -1}}, glowing({1, 0, 0}));
    const float half = node(trace_at(shade.scene, {32.5, 24}, 0.02), "R").w_bend;
    EXPECT_LE(half, open);
    EXPECT_GT(half, open / 4);
    // Nodes that are recorded behind the post are measured as if it were not there.
    const std::vector<Record> behind = trace_at(shade.scene, {24, 24}, 0.02, {2});
    const auto hidden = std::find_if(behind.begin(), behind.end(),
                                     [](const Record& r) { return r.layer == 1 && r.path.text() == "R"; });
    ASSERT_NE(hidden, behind.end());
    EXPECT_GT(hidden->w_bend, 0);
    EXPECT_LT(hidden->w_bend, 1);
}

TEST(Bend, IsInfiniteWhereNoPointOfTheLensSeesIt) {
    // A glass ball that images the wall onto the lens: its focal length is 0.3 m for n = 1.5, and
    // 1 / 0.3 = 1 / 1 + 1 / 0.4286. At its centre, each lens point sees a different point of the wall.
    SceneBuilder b;
    b.add(Sphere{{0, 0, -1}, 0.2}, glass(1.5));
    b.add(square({0, 0, -1.4286}, {0, 0, 1}, 200), glowing({0, 1, 0}));
    EXPECT_TRUE(std::isinf(node(trace_at(b.scene, {32.05, 24}, 0.05), "TT").w_bend));
    // For a wall that is farther away, w_bend is finite.
    SceneBuilder farther;
    farther.add(Sphere{{0, 0, -1}, 0.2}, glass(1.5));
    farther.add(square({0, 0, -2}, {0, 0, 1}, 200), glowing({0, 1, 0}));
    EXPECT_TRUE(std::isfinite(node(trace_at(farther.scene, {32.05, 24}, 0.05), "TT").w_bend));
}

TEST(Bend, OfGlassIsMeasuredThroughAllItsSurfaces) {
    // Points behind a pane of 5 cm move almost linearly, points behind a ball do not.
    SceneBuilder pane;
    pane.add(Box{{-5, -5, -1.05}, {5, 5, -1}}, glass(1.5));
    pane.add(square({0, 0, -4}, {0, 0, 1}, 200), glowing({0, 1, 0}));
    SceneBuilder ball;
    ball.add(Sphere{{0, 0, -1.2}, 0.2}, glass(1.5));
    ball.add(square({0, 0, -4}, {0, 0, 1}, 200), glowing({0, 1, 0}));
    const dvec2 at{36, 27};
    const float flat = node(trace_at(pane.scene, at, 0.02), "TT").w_bend,
                round = node(trace_at(ball.scene, at, 0.02), "TT").w_bend;
    EXPECT_TRUE(std::isfinite(flat));
    EXPECT_TRUE(std::isfinite(round));
    EXPECT_LT(flat, 1e-2 * round);
}

TEST(Bend, SameBitsForAnyNumberOfThreads) {
    SceneBuilder b = ball_mirror();
    b.add(Sphere{{0.5, 0.1, -1.3}, 0.2}, glass(1.5, 0.9));
    const RayScene rays(b.scene, 0);
    const CameraModel camera(b.scene.cameras[0], 0);
    const WhittedTracer tracer(rays, camera, {.bend_radius_m = 0.02}, {2});
    std::vector<Record> first;
    for (const int threads : {1, 2}) {
        const ThreadLimit limit(threads);
        std::vector<Record> got;
        (void)sample_corners(tracer, {0, 64, 0, 48}, {.levels = 1}, [&](const RecordBand& band) {
            got.insert(got.end(), band.records.begin(), band.records.end());
        });
        if (first.empty()) first = got;
        EXPECT_EQ(got, first) << threads;
    }
    EXPECT_TRUE(std::any_of(first.begin(), first.end(), [](const Record& r) { return r.w_bend > 0; }));
}

Record behind(const std::string& path, std::uint32_t id, float bend, std::uint32_t layer = 0) {
    Record r;
    for (const char c : path)
        r.path = r.path.child(c == 'R' ? NodePath::Bounce::reflected : NodePath::Bounce::transmitted);
    r.id = id;
    r.layer = layer;
    r.w_bend = bend;
    return r;
}

TEST(BendAround, IsTheGreatestOfTheSameChainWhereThatIsLittle) {
    const std::vector<Record> a{behind("", 1, 0), behind("T", 1, 9), behind("TT", 5, 0.5F)},
        b{behind("", 1, 0), behind("T", 1, 9), behind("TT", 5, 0.75F)},
        shows_other{behind("", 1, 0), behind("T", 1, 9), behind("TT", 6, 0.875F)},
        seen_in_other{behind("", 2, 0), behind("T", 1, 9), behind("TT", 5, 0.5F)}, nothing{behind("", 3, 0)};
    const NodePath path = a[2].path;
    const std::array<std::uint32_t, 2> in{1, 1};
    const float little = 1;
    EXPECT_EQ(bend_around({a, b, b, a}, {path, 5, false, in}, little), 0.75F);
    EXPECT_EQ(bend_around({a, b, shows_other, a}, {path, 5, false, in}, little), 0.875F);
    EXPECT_FALSE(bend_around({a, b, a, a}, {path, 6, false, in}, little)) << "shows another";
    EXPECT_FALSE(bend_around({a, b, seen_in_other, a}, {path, 5, false, in}, little));
    EXPECT_FALSE(bend_around({a, b, a, a}, {path, 5, true, in}, little)) << "hidden";
    EXPECT_FALSE(bend_around({a, b, a, nothing}, {path, 5, false, in}, little));
    EXPECT_FALSE(bend_around({a, b, a, {}}, {path, 5, false, in}, little));
    EXPECT_FALSE(bend_around({a, b, shows_other, a}, {path, 5, false, in}, 0.8F));
}

TEST(BendAround, IsAlsoToldWhereAllAroundHaveAboutTheSame) {
    const auto sample = [](float bend) {
        return std::vector<Record>{behind("", 1, 0), behind("T", 2, bend)};
    };
    const std::vector<Record> a = sample(10), b = sample(19), c = sample(21), none = {behind("", 4, 0)};
    const std::vector<Record> infinite = sample(std::numeric_limits<float>::infinity());
    const ChainNode node{a[1].path, 2, false, std::span(&a[0].id, 1)};
    EXPECT_EQ(bend_around({a, b, a, a}, node, 1), 19);
    EXPECT_FALSE(bend_around({a, b, c, a}, node, 1)) << "more than twice as much";
    EXPECT_FALSE(bend_around({a, b, a, none}, node, 1)) << "the chain ends there";
    EXPECT_FALSE(bend_around({none, a, a, a}, node, 1));
    EXPECT_FALSE(bend_around({a, infinite, a, a}, node, 1));
    EXPECT_EQ(bend_around({infinite, infinite, infinite, infinite}, node, 1), infinite[1].w_bend);
}

// A hidden node's layer may have all nodes of its path, or begin after a bounce.
TEST(BendAround, FindsWhatAHiddenNodeIsSeenIn) {
    const std::vector<Record> whole{behind("", 7, 0), behind("", 1, 0, 1), behind("R", 2, 0.5F, 1)},
        part{behind("", 1, 0), behind("R", 3, 0), behind("R", 2, 0.25F, 1)};
    const std::array<std::uint32_t, 1> in{1};
    const ChainNode node{whole[2].path, 2, true, in};
    EXPECT_EQ(bend_around({whole, part, part, whole}, node, 1), 0.5F);
    EXPECT_EQ(bend_around({part, part, part, part}, node, 1), 0.25F);
}

// Compares values that subdivision takes from corners with measured values. Nodes with a large error of W
// must not be missed.
TEST(Bend, OfSubdividedPixelsIsAsIfMeasured) {
    SceneBuilder b = ball_mirror();
    b.add(Sphere{{0.5, 0.1, -1.3}, 0.2}, glass(1.5, 0.9));
    constexpr double radius_m = 0.03;
    const RayScene rays(b.scene, 0);
    const CameraModel camera(b.scene.cameras[0], 0);
    const WhittedTracer tracer(rays, camera, {.bend_radius_m = radius_m});
    std::vector<Record> records;
    const RayCounts spent =
        sample_corners(tracer, {0, 64, 0, 48}, {.levels = 3}, [&](const RecordBand& band) {
            records.insert(records.end(), band.records.begin(), band.records.end());
        });
    std::vector<dvec2> places;
    for (const Record& r : records) {
        if (r.path.bits() == 0) places.emplace_back(r.x, r.y);
    }
    TracedSamples measured;
    RayCounts counts;
    tracer.trace(places, measured, counts);
    EXPECT_LT(5 * spent.lens, 4 * counts.lens) << "nothing is gained";
    ASSERT_EQ(measured.records.size(), records.size());
    const auto px = [&](const Record& r) {
        return static_cast<double>(r.w_bend) * radius_m * radius_m / tangent_per_px;
    };
    int wrong = 0, missed = 0, false_alarms = 0, nodes = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        ASSERT_EQ(records[i].path, measured.records[i].path);
        nodes += records[i].path.depth() > 0 ? 1 : 0;
        const double told = px(records[i]), is = px(measured.records[i]);
        // Errors above half a pixel have consequences. On the balls, 20 px wide, the error changes by half of
        // itself between neighbouring pixels.
        wrong += is > 0.5 ? 1 : 0;
        missed += is > 0.5 && told < 0.25 ? 1 : 0;
        false_alarms += told > 0.5 && is < 0.25 ? 1 : 0;
    }
    EXPECT_GT(nodes, 2000);
    EXPECT_GT(wrong, nodes / 100);
    // The image of the glass ball in the mirror is only two pixels wide, so corners miss some of it.
    EXPECT_LE(missed, wrong / 30);
    EXPECT_EQ(false_alarms, 0);
}

TEST(BendWarning, SaysWhichShareWIsWrongFor) {
    const TemporaryFolder folder;
    const auto warning = [&](const SceneBuilder& b, double f_number, double zoom = 1) {
        TraceSettings t;
        t.for_f_number = 0.7;
        (void)trace_to_file(b.scene, t, folder.path() / "a.exr");
        const SampleFileReader file(folder.path() / "a.exr");
        EXPECT_TRUE(file.header().has_bend);
        FocusGeometry lens = focus_geometry({50, f_number}, 2, Framing::keep, {50, 36.0 / 64});
        lens.gain_px *= zoom;
        FocusFrame frame(file);
        return bend_warning(frame, lens);
    };
    SceneBuilder ball;
    ball.add(Sphere{{0, 0, -1}, 0.15}, mirror(0.9));
    ball.add(square({0, 0, 3}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    ball.add(square({0, 0, -6}, {0, 0, 1}, 200), glowing({1, 0, 0}));
    const auto wide = warning(ball, 0.7);
    ASSERT_TRUE(wide.has_value());
    EXPECT_EQ(wide->code, "nonlinear");
    // The ball covers pi (0.15 / sqrt(1 - 0.15^2))^2 / tangent_per_px^2 = 571 of 3072 pixels. Pixels at its
    // outline also count: at most twice 2 pi 13.5 px.
    EXPECT_GT(wide->share, 0);
    EXPECT_LE(wide->share, (571.0 + 170) / 3072);
    // The share increases with the resolution. At the smallest aperture only nodes remain that no other lens
    // point was found to see.
    const auto fine = warning(ball, 0.7, 100), least = warning(ball, 1000);
    ASSERT_TRUE(fine.has_value() && least.has_value());
    EXPECT_GT(fine->share, wide->share);
    EXPECT_LE(least->share, wide->share);
    EXPECT_FALSE(warning(ball, std::numeric_limits<double>::infinity()).has_value());
    SceneBuilder flat;
    flat.add(square({0, 0, -3}, {0, 0, 1}, 3), mirror(0.8));
    flat.add(square({0, 0, 6}, {0, 0, -1}, 200), glowing({0, 1, 0}));
    EXPECT_FALSE(warning(flat, 0.7).has_value());
}

}  // namespace
}  // namespace postlens::test::refocus_bend_test
