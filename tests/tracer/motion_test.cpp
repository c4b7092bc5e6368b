// Keyed motion for rays: MotionPath against transform_at, and the steps and boxes that Embree gets.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "records/motion/motion_path.h"
#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tracer/intersection/motion_steps.h"

namespace postlens::test::motion_test {
namespace {

using glm::dmat4;
using glm::dvec3;

double largest_difference(const dmat4& a, const dmat4& b) {
    double most = 0;
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) most = std::max(most, std::abs(a[c][r] - b[c][r]));
    }
    return most;
}

dvec3 apply(const dmat4& m, const dvec3& p) {
    return dvec3(m * glm::dvec4(p, 1));
}

// Both versions use the same arithmetic, except that a division became a multiplication. Fractions of an
// interval, sines in [0, 1] and entries below 3 therefore differ by a few 2^-53.
constexpr double path_tolerance = 1e-12;

void expect_same_path(const std::vector<TransformKey>& keys, RandomNumbers& random, const char* what) {
    const MotionPath path(keys);
    const double begin = keys.front().time_s, end = keys.back().time_s, margin = 0.3 * (end - begin) + 0.1;
    std::vector<double> times;
    for (int i = 0; i < 40; ++i) times.push_back(random.in(begin - margin, end + margin));
    for (const TransformKey& k : keys) {
        for (const double side : {-1.0, 1.0})
            times.push_back(std::nextafter(k.time_s, side * std::numeric_limits<double>::infinity()));
        times.push_back(k.time_s);
    }
    for (const double t : times) {
        const dmat4 expected = transform_at(keys, t), got = path.at(t).matrix();
        EXPECT_LE(largest_difference(got, expected), path_tolerance) << what << " at " << t;
        const dvec3 p = random.in_box(1);
        EXPECT_LE(glm::length(path.at(t).point(p) - apply(expected, p)), 4 * path_tolerance) << what;
        EXPECT_LE(glm::length(path.at(t).direction(p) - dvec3(expected * glm::dvec4(p, 0))),
                  4 * path_tolerance)
            << what;
    }
}

TEST(MotionPaths, AreWhatTransformAtSays) {
    RandomNumbers random(1);
    for (int i = 0; i < 200; ++i) {
        std::vector<double> times{random.in(-5, 5)};
        const int count = 1 + i % 5;
        for (int k = 1; k < count; ++k) times.push_back(times.back() + std::exp(random.in(-6, 2)));
        expect_same_path(random_keys(random, times), random, "random keys");
    }
}

TEST(MotionPaths, TakeTheShortWayRoundAndTinyAnglesStraight) {
    RandomNumbers random(2);
    // Near 2e-8 (cosine = 1 - epsilon) slerp becomes linear. For 180 degrees there is no shorter arc.
    for (const double angle : {0.0, 1e-12, 1e-9, 2e-8, 5e-8, 1e-6, 1e-3, 1.0, 3.0, 3.1415}) {
        for (const double sign : {1.0, -1.0}) {
            auto keys = random_keys(random, {0, 1});
            keys[1].rotation = sign * (random.turn(angle) * keys[0].rotation);
            expect_same_path(keys, random, "one angle");
            // The rotation is never larger than the angle, for either sign of the quaternion.
            const MotionPath::Pose a = MotionPath(keys).at(0), b = MotionPath(keys).at(0.37);
            const dvec3 axis = random.direction();
            const double cosine = glm::dot(a.rotation * axis, b.rotation * axis);
            EXPECT_LE(std::acos(std::clamp(cosine, -1.0, 1.0)), 0.37 * angle + 1e-7);
        }
    }
}

TEST(MotionPaths, NoKeysAndOneKeyStandStill) {
    const MotionPath none;
    EXPECT_EQ(none.at(3).matrix(), dmat4(1));
    EXPECT_FALSE(none.moves(-1e9, 1e9));
    RandomNumbers random(3);
    const auto keys = random_keys(random, {0.5});
    const MotionPath one(keys);
    for (const double t : {-1e9, 0.5, 1e9})
        EXPECT_LE(largest_difference(one.at(t).matrix(), transform_at(keys, t)), path_tolerance);
    EXPECT_FALSE(one.moves(-1e9, 1e9));
    EXPECT_EQ(one.intervals(0, 1), (std::vector<double>{0, 0.5, 1}));
}

TEST(MotionPaths, AreUndoneByTheirPoses) {
    RandomNumbers random(4);
    for (int i = 0; i < 500; ++i) {
        const MotionPath path(random_keys(random, {0, 0.4, 1}));
        const MotionPath::Pose pose = path.at(random.in(-0.2, 1.2));
        const dvec3 p = random.in_box(2), v = random.in_box(2);
        // A rotation by slerp is orthogonal to a few 2^-52. Scales of at least 0.6 add a factor of at most 2.
        EXPECT_LE(glm::length(pose.unmoved_point(pose.point(p)) - p), 1e-13);
        EXPECT_LE(glm::length(pose.unmoved_direction(pose.direction(v)) - v), 1e-13);
        EXPECT_LE(glm::length(pose.point(pose.unmoved_point(p)) - p), 1e-13);
    }
}

TEST(MotionPaths, KnowWhenTheyMove) {
    RandomNumbers random(5);
    auto keys = random_keys(random, {0, 1, 2, 3});
    keys[2].translation = keys[1].translation;  // no motion from 1 s to 2 s
    keys[2].rotation = keys[1].rotation;
    keys[2].scale = keys[1].scale;
    const MotionPath path(keys);
    EXPECT_TRUE(path.moves(0.5, 0.6));
    EXPECT_TRUE(path.moves(-1, 1e-9));
    EXPECT_TRUE(path.moves(1.5, 2.0 + 1e-9));
    EXPECT_TRUE(path.moves(-5, 5));
    EXPECT_FALSE(path.moves(1, 2));  // only the ends touch moving intervals
    EXPECT_FALSE(path.moves(1.2, 1.7));
    EXPECT_FALSE(path.moves(-2, 0));
    EXPECT_FALSE(path.moves(3, 9));
    EXPECT_FALSE(path.moves(0.5, 0.5));  // an instant
    EXPECT_FALSE(path.moves(0.6, 0.5));
    for (int c = 0; c < 3; ++c) {
        // Translation, rotation and scale each count as motion.
        std::vector<TransformKey> one{TransformKey{}, TransformKey{}};
        one[1].time_s = 1;
        if (c == 0) one[1].translation.y = 1e-9;
        if (c == 1) one[1].rotation = glm::angleAxis(1e-6, dvec3(0, 1, 0));
        if (c == 2) one[1].scale.z = 1 + 1e-9;
        EXPECT_TRUE(MotionPath(one).moves(0, 1)) << c;
    }
}

TEST(MotionPaths, ListTheKeysWithin) {
    RandomNumbers random(6);
    const MotionPath path(random_keys(random, {0, 1, 2, 3}));
    EXPECT_EQ(path.intervals(0.5, 2.5), (std::vector<double>{0.5, 1, 2, 2.5}));
    EXPECT_EQ(path.intervals(1, 2), (std::vector<double>{1, 2}));  // an end is listed once
    EXPECT_EQ(path.intervals(1.25, 1.5), (std::vector<double>{1.25, 1.5}));
    EXPECT_EQ(path.intervals(5, 6), (std::vector<double>{5, 6}));
    EXPECT_EQ(MotionPath().intervals(0, 1), (std::vector<double>{0, 1}));
}

// Error of Embree's interpolation between steps at one instant, m.
double strays_m(const std::vector<dmat4>& steps, const MotionPath& path, const dmat4& base, const Bounds& box,
                double share, double time_s) {
    const auto last = static_cast<double>(steps.size() - 1);
    const double position = share * last;
    const auto k = static_cast<std::size_t>(std::min(position, last - 1));
    const double within = position - static_cast<double>(k);
    const dmat4 taken = steps[k] * (1 - within) + steps[k + 1] * within;
    const dmat4 truth = path.at(time_s).matrix() * base;
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p{(corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                      (corner & 4) != 0 ? box.max.z : box.min.z};
        most = std::max(most, glm::length(apply(taken, p) - apply(truth, p)));
    }
    return most;
}

// Ratio of the greatest error to the measured one. The error vanishes at the ends of a step and is measured
// at 1/4, 1/2 and 3/4 of it. The peak of a parabola is at most 1/8 from such an instant, unless it is near an
// end, and so exceeds the measured value by at most (2/8)^2 = 1/16. Twice that is allowed for other shapes.
constexpr double unseen = 1.125;

TEST(MotionStepCounts, KeepTheirPromiseAndAreNotMoreThanItTakes) {
    RandomNumbers random(7);
    const Bounds box{{-1, -0.5, -0.2}, {0.7, 1, 0.4}};
    constexpr double px_per_m = 400;
    int counts = 0;
    for (int i = 0; i < 60; ++i) {
        const double begin = random.in(-1, 1), end = begin + random.in(0.1, 2);
        RandomKeys options;
        options.angle = std::exp(random.in(-6, 1));
        options.scale_low = options.scale_high = 1;
        if (i % 2 == 0) options = {1.5, 1.0, 0.6, 1.6};
        const MotionPath path(random_keys(random, {begin - 0.5, end + 0.5}, options));
        const dmat4 base = glm::translate(dmat4(1), random.in_box(1));
        const MotionAccuracy accuracy{[&](const dvec3&, double) { return px_per_m; }, 0.05};
        const MotionSteps steps = motion_steps(path, base, box, begin, end, accuracy);
        const std::size_t count = steps.world_from_object.size() - 1;
        ASSERT_GE(count, 1U);
        EXPECT_EQ(count & (count - 1), 0U) << "doubling";
        EXPECT_LE(steps.error_px, accuracy.tolerance_px);
        for (int k = 0; k < 200; ++k) {
            const double share = random.in(0, 1);
            const double error_m =
                strays_m(steps.world_from_object, path, base, box, share, begin + share * (end - begin));
            EXPECT_LE(error_m * px_per_m, unseen * accuracy.tolerance_px) << count << " steps";
        }
        // Every step has the exact transform.
        for (std::size_t k = 0; k <= count; ++k) {
            const double t = begin + (end - begin) * static_cast<double>(k) / static_cast<double>(count);
            EXPECT_LE(largest_difference(steps.world_from_object[k], path.at(t).matrix() * base), 1e-12);
        }
        counts |= static_cast<int>(count);
        if (count == 1) continue;
        std::vector<dmat4> half;
        for (std::size_t k = 0; k <= count; k += 2) half.push_back(steps.world_from_object[k]);
        double most = 0;
        for (int k = 0; k < 2000; ++k) {
            const double share = (k + 0.5) / 2000;
            most = std::max(most, strays_m(half, path, base, box, share, begin + share * (end - begin)));
        }
        EXPECT_GT(most * px_per_m, accuracy.tolerance_px) << "half as many would do";
    }
    EXPECT_GT(counts, 8) << "the paths should ask for different numbers of steps";
}

TEST(MotionStepCounts, ExceedHonestlyWhereTheMostDoNotSuffice) {
    RandomNumbers random(8);
    const Bounds box{{-1, -1, -1}, {1, 1, 1}};
    constexpr double px_per_m = 1e6;
    const MotionPath path(random_keys(random, {0, 1}, {1, 3, 1, 1}));
    const MotionAccuracy accuracy{[&](const dvec3&, double) { return px_per_m; }, 0.05};
    const MotionSteps steps = motion_steps(path, dmat4(1), box, 0, 1, accuracy);
    EXPECT_EQ(steps.world_from_object.size(), most_motion_steps + 1U);
    EXPECT_GT(steps.error_px, accuracy.tolerance_px);
    double most_px = 0;
    for (int k = 0; k < 20000; ++k) {
        const double share = (k + 0.5) / 20000;
        most_px = std::max(most_px,
                           px_per_m * strays_m(steps.world_from_object, path, dmat4(1), box, share, share));
    }
    EXPECT_LE(most_px, unseen * steps.error_px);
    EXPECT_GE(most_px, 0.99 * steps.error_px);  // 156 instants per step: one is at most 1/312 from the worst
}

TEST(MotionStepCounts, OneForStraightLinesAndForWhatIsNotSeen) {
    RandomNumbers random(9);
    const Bounds box{{-1, -1, -1}, {1, 1, 1}};
    auto straight = random_keys(random, {0, 1});
    straight[1].rotation = straight[0].rotation;
    const MotionAccuracy seen{[](const dvec3&, double) { return 1e6; }, 0.05};
    const MotionSteps line = motion_steps(MotionPath(straight), dmat4(1), box, 0, 1, seen);
    EXPECT_EQ(line.world_from_object.size(), 2U);
    EXPECT_LE(line.error_px, 1e6 * 1e-14);  // rounding errors of positions
    const MotionPath turning(random_keys(random, {0, 1}));
    const MotionAccuracy unseen_there{[](const dvec3&, double) { return 0.0; }, 0.05};
    EXPECT_EQ(motion_steps(turning, dmat4(1), box, 0, 1, unseen_there).world_from_object.size(), 2U);
}

TEST(MovingBounds, HoldTheShapeAllTheTimeWithKinksAtKeys) {
    RandomNumbers random(10);
    auto mesh = std::make_shared<Mesh>(*sphere_mesh(4, 6, false));
    mesh->positions.emplace_back(2, 0.1, -0.3);
    const std::vector<Shape> shapes{Sphere{{0.2, 0, 0}, 0.7},
                                    Box{{-1, -0.1, -0.2}, {1, 0.3, 0.2}},
                                    Disc{{0, 0.1, 0}, {1, 2, 3}, 1.2, 0.3},
                                    Rectangle{{-1, 0, 0}, {2, 0, 0.1}, {0, 0.5, 0}},
                                    Cone{{0, 0, -1}, {0.2, 0, 2}, 0.3, 0.1, true},
                                    std::shared_ptr<const Mesh>(mesh)};
    for (int i = 0; i < 90; ++i) {
        const Shape& shape = shapes[static_cast<std::size_t>(i) % shapes.size()];
        std::vector<double> times{-0.2, 1.3};
        for (int k = 0; k < i % 4; ++k) times.push_back(random.in(0, 1));
        std::sort(times.begin(), times.end());
        const MotionPath path(random_keys(random, times));
        const dmat4 base = glm::translate(dmat4(1), random.in_box(1));
        for (const int steps : {1, 2, 5, 32}) {
            const std::vector<Bounds> boxes = moving_bounds(path, shape, base, 0, 1, steps);
            ASSERT_EQ(boxes.size(), static_cast<std::size_t>(steps) + 1);
            std::vector<double> shares = times;
            for (int k = 0; k < 150; ++k) shares.push_back(random.in(0, 1));
            for (const double share : shares) {
                if (share < 0 || share > 1) continue;
                const double position = share * steps;
                const auto k = static_cast<std::size_t>(std::min(position, steps - 1.0));
                const double within = position - static_cast<double>(k);
                const Bounds b = shape_bounds(shape, path.at(share).matrix() * base);
                const dvec3 lower = glm::mix(boxes[k].min, boxes[k + 1].min, within);
                const dvec3 upper = glm::mix(boxes[k].max, boxes[k + 1].max, within);
                for (int c = 0; c < 3; ++c) {
                    EXPECT_LE(lower[c], b.min[c] + 1e-12) << steps << " steps, shape " << shape.index();
                    EXPECT_GE(upper[c], b.max[c] - 1e-12) << steps << " steps, shape " << shape.index();
                }
            }
        }
    }
}

TEST(MovingBounds, OfAStraightPathAreTight) {
    std::vector<TransformKey> keys(2);
    keys[1].time_s = 1;
    keys[1].translation = dvec3(3, 0, 0);
    const auto boxes = moving_bounds(MotionPath(keys), Sphere{}, dmat4(1), 0, 1, 3);
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        EXPECT_NEAR(boxes[k].min.x, static_cast<double>(k) - 1, 1e-12);
        EXPECT_NEAR(boxes[k].max.x, static_cast<double>(k) + 1, 1e-12);
        EXPECT_NEAR(boxes[k].max.y, 1, 1e-12);
    }
}

TEST(MovingBounds, OfAPlaneStayFinite) {
    std::vector<TransformKey> keys(2);
    keys[1].time_s = 1;
    keys[1].rotation = glm::angleAxis(1.0, dvec3(0, 1, 0));
    for (const Bounds& b : moving_bounds(MotionPath(keys), Plane{}, dmat4(1), 0, 1, 2)) {
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::isfinite(b.min[c]) && b.min[c] <= -1e18);
            EXPECT_TRUE(std::isfinite(b.max[c]) && b.max[c] >= 1e18);
        }
    }
}

}  // namespace
}  // namespace postlens::test::motion_test
