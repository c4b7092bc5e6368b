// Channels beside a focused image: CoC, what is before, in and behind the focus, Cryptomatte, error.
#include "focus/focus_passes.h"

#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/error.h"
#include "pictures/foreign/cryptomatte.h"
#include "tests/support/edge_response.h"
#include "tests/support/stack_bench.h"

namespace postlens::test::focus_passes_test {
namespace {

using Bench = StackBench;

constexpr int x0 = 40, views = 1024;

ForeignPicture card(const Bench& bench, float wall_alpha = 1) {
    ForeignPicture p = bench.picture([&](int x, int) {
        const StackSample wall{bench.inverse_z(6), 0,          0.25F * wall_alpha,
                               wall_alpha,         wall_alpha, cryptomatte_id("wall")};
        if (x < x0) return Stack{wall};
        return Stack{{bench.inverse_z(-8), 1, 0.5F, 0, 1, cryptomatte_id("card")}, wall};
    });
    p.channels.matte = Cryptomatte{"CryptoObject", {}, "{}"};
    return p;
}

FocusSettings settings_of(const Bench& bench, FocusMethod method) {
    FocusSettings s = bench.settings;
    s.method = method;
    s.lens = {.focal_length_mm = 2000, .f_number = 1};
    s.focus_distance_m = 1 / bench.inverse_focus_per_m;
    s.views = views;
    return s;
}

const std::vector<float>& plane(const Image& image, const std::string& name) {
    for (const Image::Plane& p : image.planes) {
        if (p.name == name) return p.values;
    }
    throw std::runtime_error("no plane " + name);
}

/// Coverage of a name in a pixel.
float coverage(const Image& image, const std::string& name, std::size_t pixel) {
    float out = 0;
    for (const Image::Plane& p : image.planes) {
        if (p.name.rfind("CryptoObject", 0) != 0 || (p.name.back() != 'R' && p.name.back() != 'B')) continue;
        if (std::bit_cast<std::uint32_t>(p.values[pixel]) != cryptomatte_id(name)) continue;
        std::string of = p.name;
        of.back() = of.back() == 'R' ? 'G' : 'A';
        out += plane(image, of)[pixel];
    }
    return out;
}

TEST(FocusPasses, CoverageThroughTheLensIsTheEdgeOfTheObject) {
    const Bench bench{.width = 80, .height = 4, .margin_px = 40};
    const ForeignPicture p = card(bench);
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusSettings s = settings_of(bench, method);
        Image image = focus_foreign(p, s).image;
        add_focus_passes(p, s, {.sides = true, .cryptomatte = true}, image);
        for (int x = 0; x < bench.width; ++x) {
            const auto k = static_cast<std::size_t>(bench.width + x);
            // The error of 1024 scrambled Sobol points at an edge is well below 1/2 / sqrt(1024).
            const double front = edge_response((x + 0.5 - x0) / 8);
            EXPECT_NEAR(coverage(image, "card", k), front, 0.016) << x;
            EXPECT_NEAR(coverage(image, "card", k) + coverage(image, "wall", k), 1, 2e-4) << x;
            EXPECT_NEAR(plane(image, "focus.before")[k], coverage(image, "card", k), 2e-4) << x;
            EXPECT_NEAR(plane(image, "focus.behind")[k], coverage(image, "wall", k), 2e-4) << x;
            EXPECT_EQ(plane(image, "focus.in")[k], 0) << x;
        }
        EXPECT_EQ(image.texts.size(), 4U);
        EXPECT_EQ(image.texts[0].second, "CryptoObject");
    }
}

// Behind the card, the image has nothing. What blur shows there is estimated from the wall, and is the
// wall's.
TEST(FocusPasses, WhatIsEstimatedBehindAnEdgeIsOfTheObjectFoundThere) {
    const Bench bench{.width = 80, .height = 4, .margin_px = 40};
    ForeignPicture p = bench.picture([&](int x, int) {
        return x < x0 ? Stack{{bench.inverse_z(6), 0, 0.25F, 1, 1, cryptomatte_id("wall")}}
                      : Stack{{bench.inverse_z(-8), 1, 0.5F, 0, 1, cryptomatte_id("card")}};
    });
    p.channels.matte = Cryptomatte{"CryptoObject", {}, "{}"};
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusSettings s = settings_of(bench, method);
        Image image = focus_foreign(p, s).image;
        add_focus_passes(p, s, {.cryptomatte = true}, image);
        for (int x = 0; x < bench.width; ++x) {
            const auto k = static_cast<std::size_t>(bench.width + x);
            EXPECT_NEAR(coverage(image, "wall", k), 1 - edge_response((x + 0.5 - x0) / 8), 0.016) << x;
            EXPECT_NEAR(coverage(image, "card", k) + coverage(image, "wall", k), 1, 2e-4) << x;
        }
    }
}

TEST(FocusPasses, PixelsWithMoreObjectsThanRanksAreCounted) {
    const Bench bench{.width = 40, .height = 2, .margin_px = 0};
    ForeignPicture p = bench.picture([&](int x, int) {
        return Stack{{bench.inverse_z(6), 1, 1, 1, 1, cryptomatte_id("object" + std::to_string(x))}};
    });
    p.channels.matte = Cryptomatte{"CryptoObject", {}, "{}"};
    const auto beyond_ranks = [&](FocusMethod method) {
        const FocusSettings s = settings_of(bench, method);
        Image image = focus_foreign(p, s).image;
        return add_focus_passes(p, s, {.cryptomatte = true}, image);
    };
    EXPECT_EQ(beyond_ranks(FocusMethod::pinhole), 0);
    // A circle of confusion with a radius of 6 px covers 12 columns, each of which is an object.
    EXPECT_GE(beyond_ranks(FocusMethod::layers), (40 - 2 * 6) / 40.0);
}

TEST(FocusPasses, CoveragesAddUpToAlpha) {
    const Bench bench{.width = 80, .height = 4, .margin_px = 40};
    const ForeignPicture p = card(bench, 0.5F);
    for (const FocusMethod method : {FocusMethod::pinhole, FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusSettings s = settings_of(bench, method);
        Image image = focus_foreign(p, s).image;
        add_focus_passes(p, s, {.sides = true, .cryptomatte = true}, image);
        for (int x = 0; x < bench.width; ++x) {
            const auto k = static_cast<std::size_t>(bench.width + x);
            EXPECT_NEAR(coverage(image, "card", k) + coverage(image, "wall", k), alpha(image, x, 1), 2e-4)
                << x;
            EXPECT_NEAR(plane(image, "focus.before")[k] + plane(image, "focus.in")[k] +
                            plane(image, "focus.behind")[k],
                        alpha(image, x, 1), 1e-5)
                << x;
        }
    }
}

// Where the lens has no effect, the image is the pinhole's, and so is the Cryptomatte.
TEST(FocusPasses, WhereTheLensHasNoEffectCoveragesAreThePinholes) {
    const Bench bench{.width = 80, .height = 4, .margin_px = 40};
    const ForeignPicture p = card(bench);
    const FocusSettings s = settings_of(bench, FocusMethod::layers);
    std::vector<float> effect(static_cast<std::size_t>(bench.width * bench.height), 0.0F);
    for (int x = 0; x < bench.width; ++x)
        effect[static_cast<std::size_t>(bench.width + x)] = static_cast<float>(x % 3) / 2;
    Image image = focus_foreign(p, s).image;
    add_focus_passes(p, s, {.sides = true, .cryptomatte = true}, image, effect);
    for (int x = 0; x < bench.width; ++x) {
        const auto k = static_cast<std::size_t>(bench.width + x);
        const double sharp = x < x0 ? 0 : 1, soft = edge_response((x + 0.5 - x0) / 8);
        EXPECT_NEAR(coverage(image, "card", k), sharp + static_cast<double>(effect[k]) * (soft - sharp),
                    0.016)
            << x;
        EXPECT_NEAR(coverage(image, "card", k) + coverage(image, "wall", k), 1, 2e-4) << x;
        EXPECT_NEAR(plane(image, "focus.in")[k], 1 - effect[k], 2e-4) << x;
    }
}

TEST(FocusPasses, CocIsSignedAndOfWhatThePinholeSees) {
    const Bench bench{.width = 80, .height = 4};
    const ForeignPicture p = card(bench);
    Image image(bench.width, bench.height);
    add_focus_passes(p, settings_of(bench, FocusMethod::scatter), {.coc = true}, image);
    const std::vector<float>& coc = plane(image, "CoC");
    EXPECT_NEAR(coc[0], 12, 1e-3);
    EXPECT_NEAR(coc[79], -16, 1e-3);
    // Where the lens has a part of its effect, so has the circle.
    std::vector<float> effect(coc.size(), 1.0F);
    effect[79] = 0.25F;
    Image limited(bench.width, bench.height);
    add_focus_passes(p, settings_of(bench, FocusMethod::scatter), {.coc = true}, limited, effect);
    EXPECT_NEAR(plane(limited, "CoC")[79], -4, 1e-3);
}

TEST(FocusPasses, ErrorIsNoneWhereAllViewsAgreeAndThatOfTheViewsAtEdges) {
    const Bench bench{.width = 80, .height = 16, .margin_px = 40};
    const ForeignPicture p = card(bench);
    FocusSettings s = settings_of(bench, FocusMethod::lightfield);
    s.views = 64;
    Image image = focus_foreign(p, s).image;
    add_focus_passes(p, s, {.error = true}, image);
    const std::vector<float>& error = plane(image, "error");
    EXPECT_NEAR(error[static_cast<std::size_t>(5 * bench.width)], 0, 1e-6);
    // The mean square over the columns at the edge, against the true error there: the same within a factor of
    // 4, since both are sums over some 16 x 16 pixels that see the same 64 points.
    double stated = 0, measured = 0;
    for (int y = 0; y < bench.height; ++y) {
        for (int x = x0 - 7; x < x0 + 7; ++x) {
            const auto k = static_cast<std::size_t>(y * bench.width + x);
            const double d = static_cast<double>(value(image, x, y, 0)) - edge_response((x + 0.5 - x0) / 8);
            measured += d * d;
            stated += static_cast<double>(error[k]) * static_cast<double>(error[k]);
        }
    }
    EXPECT_GT(stated, measured / 16);
    EXPECT_LT(stated, measured * 16);
    s.method = FocusMethod::layers;
    EXPECT_THROW(add_focus_passes(p, s, {.error = true}, image), Error);
}

TEST(FocusPasses, ErrorOfFewViewsIsThatOfTheirNumber) {
    // Random pixels of one depth: all pixels share the lens points, of which two sets of a view or two may
    // agree by chance.
    const Bench bench{.width = 48, .height = 48, .margin_px = 8};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    const ForeignPicture p = bench.picture([&](int, int) {
        return Stack{{bench.inverse_z(1), unit(random), unit(random), unit(random), 1}};
    });
    FocusSettings s = settings_of(bench, FocusMethod::lightfield);
    s.views = 4096;
    const Image truth = focus_foreign(p, s).image;
    for (const int count : {1, 3, 4, 5}) {
        s.views = count;
        Image image = focus_foreign(p, s).image;
        add_focus_passes(p, s, {.error = true}, image);
        double stated = 0, measured = 0;
        for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
            const auto d = static_cast<double>(image.rgb[i]) - static_cast<double>(truth.rgb[i]);
            measured += d * d / 3;
        }
        for (const float e : plane(image, "error")) stated += static_cast<double>(e) * static_cast<double>(e);
        EXPECT_GT(stated, measured / 4) << count;
        EXPECT_LT(stated, measured * 4) << count;
    }
}

TEST(FocusPasses, ErrorOfAnEvenPictureIsNoneAtItsBorderToo) {
    const Bench bench{.width = 40, .height = 16};
    const ForeignPicture p = bench.picture([&](int, int) {
        return Stack{{bench.inverse_z(6), 0.5F, 0.5F, 0.5F, 1}};
    });
    FocusSettings s = settings_of(bench, FocusMethod::lightfield);
    s.views = 64;
    Image image = focus_foreign(p, s).image;
    add_focus_passes(p, s, {.error = true}, image);
    for (const float e : plane(image, "error")) EXPECT_NEAR(e, 0, 1e-6);
}

TEST(FocusPasses, APictureWithoutACryptomatteHasNone) {
    const Bench bench{.width = 8, .height = 4};
    const ForeignPicture p = bench.picture([](int, int) { return Stack{{1, 1, 1, 1}}; });
    Image image(8, 4);
    EXPECT_THROW(add_focus_passes(p, settings_of(bench, FocusMethod::layers), {.cryptomatte = true}, image),
                 Error);
}

}  // namespace
}  // namespace postlens::test::focus_passes_test
