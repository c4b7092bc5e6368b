// The lens points of views: uniform, nested, and independent between sets.
#include "focus/light_field/lens_views.h"

#include <cmath>
#include <gtest/gtest.h>

namespace postlens::test::lens_views_test {
namespace {

FocusGeometry geometry() {
    FocusGeometry g;
    g.gain_px = 1000;
    g.aperture_radius_m = 0.01;
    g.inverse_focus_per_m = 0.3;
    return g;
}

// Coverage of a pixel by a defocused half-plane: the fraction of the views that see it. `blur_px` is the
// width of the blur, `angle` the direction of the edge and `offset_px` its distance.
double seen_share(const std::vector<LensViewPoint>& points, double blur_px, double angle, double offset_px) {
    double sum = 0;
    for (const LensViewPoint& p : points) {
        const glm::dvec2 at = p.place - 0.5 + blur_px * p.lens;
        sum += std::cos(angle) * at.x + std::sin(angle) * at.y < offset_px ? 1 : 0;
    }
    return sum / static_cast<double>(points.size());
}

TEST(LensViewPoints, BeginAlikeHoweverManyThereAre) {
    const Aperture disc{Impulse{}};
    const auto few = lens_view_points(disc, geometry(), 24, 5),
               many = lens_view_points(disc, geometry(), 1000, 5);
    for (std::size_t i = 0; i < few.size(); ++i) {
        EXPECT_EQ(few[i].lens, many[i].lens);
        EXPECT_EQ(few[i].place, many[i].place);
        EXPECT_EQ(few[i].light_before, many[i].light_before);
        EXPECT_TRUE(few[i].shift == many[i].shift);
    }
}

TEST(LensViewPoints, EveryPlaceAndInstantHasItsShare) {
    // Each of 2^k equal intervals of the pixel's x, of its y and of the exposure holds one of 2^k points.
    const Aperture disc{Impulse{}};
    for (const int set : {0, 1, 7}) {
        const auto points = lens_view_points(disc, geometry(), 64, set);
        std::array<std::vector<int>, 3> found;
        for (auto& f : found) f.assign(64, 0);
        for (const LensViewPoint& p : points) {
            ASSERT_LE(glm::length(p.lens), 1 + 1e-12);
            ++found[0].at(static_cast<std::size_t>(64 * p.place.x));
            ++found[1].at(static_cast<std::size_t>(64 * p.place.y));
            ++found[2].at(static_cast<std::size_t>(64 * p.light_before));
        }
        for (const auto& f : found) EXPECT_EQ(f, std::vector<int>(64, 1));
    }
}

// On 200 edges of all angles, blurred or not, the mean of half the squared difference of two sets equals the
// squared error of one set to 1 dB; there are enough pairs for the noise to be smaller. 64 points are more
// accurate than four times as many random points.
TEST(LensViewPoints, HalfTheDifferenceOfTwoSetsIsTheErrorOfOne) {
    const Aperture disc{Impulse{}};
    constexpr int pairs = 200;
    std::vector<std::vector<LensViewPoint>> sets;
    for (int s = 0; s < 2 * pairs; ++s) sets.push_back(lens_view_points(disc, geometry(), 64, s));
    const auto truth_points = lens_view_points(disc, geometry(), most_lens_views, 4001);
    int good = 0, edges = 0;
    double all = 0;
    for (const double blur_px : {0.0, 0.3, 1.0, 4.0, 16.0}) {
        for (int k = 0; k < 40; ++k, ++edges) {
            const double angle = 0.1 + 0.157 * k,
                         offset_px = (blur_px + 0.5) * (0.9 * ((7 * k) % 40) / 40.0 - 0.45);
            double truth = 0;
            for (const auto& s : sets) truth += seen_share(s, blur_px, angle, offset_px) / (2 * pairs);
            double stated = 0, is = 0;
            for (int p = 0; p < pairs; ++p) {
                const auto k0 = static_cast<std::size_t>(2 * p);
                const double a = seen_share(sets[k0], blur_px, angle, offset_px),
                             b = seen_share(sets[k0 + 1], blur_px, angle, offset_px);
                stated += (a - b) * (a - b) / 2 / pairs;
                is += ((a - truth) * (a - truth) + (b - truth) * (b - truth)) / 2 / pairs;
            }
            // The mean of all sets agrees with the truth to three standard deviations of as many random
            // points.
            EXPECT_NEAR(truth, seen_share(truth_points, blur_px, angle, offset_px),
                        3 * std::sqrt(truth * (1 - truth) / most_lens_views) + 1e-9);
            good += std::abs(10 * std::log10(stated / is)) < 1 ? 1 : 0;
            all += is;
            // The variance of 64 random points is p (1 - p) / 64.
            EXPECT_LT(is, truth * (1 - truth) / 64);
        }
    }
    EXPECT_GE(good, 95 * edges / 100);
    EXPECT_LT(all / edges, 0.25 / 64 / 4);
}

}  // namespace
}  // namespace postlens::test::lens_views_test
