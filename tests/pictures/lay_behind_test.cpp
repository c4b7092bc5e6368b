// Images of one camera behind each other.
#include "pictures/stacks/lay_behind.h"

#include <gtest/gtest.h>
#include <random>
#include <string>

#include "core/error.h"
#include "pictures/foreign/cryptomatte.h"
#include "tests/support/stack_bench.h"

namespace postlens::test::lay_behind_test {
namespace {

using Bench = StackBench;

/// What a test says of a sample.
StackSample sample(float z_m, float grey, float a = 1) {
    return {1 / z_m, grey, grey, grey, a};
}

TEST(LayBehind, WhatTheFrontHidesIsAddedAndWhatItShowsIsNot) {
    const Bench bench{.width = 8, .height = 2};
    ForeignPicture front =
        bench.picture([](int x, int) { return x < 4 ? Stack{sample(1, 0.9F)} : Stack{sample(5, 0.2F)}; });
    const ForeignPicture back = bench.picture([](int, int) { return Stack{sample(5, 0.2F)}; });
    const Image before = front.flattened();
    const LaidBehind laid = lay_behind(front, back, "back.exr");
    EXPECT_EQ(laid.samples, 8U);
    EXPECT_EQ(laid.nearer_share, 0);
    for (int x = 0; x < 8; ++x) EXPECT_EQ(front.stack(x, 1).size(), x < 4 ? 2U : 1U) << x;
    EXPECT_EQ(front.flattened().rgb, before.rgb);
    EXPECT_TRUE(front.flattened().alpha.empty());
}

TEST(LayBehind, IsWhatOneDeepImageWouldHold) {
    // Random stacks that end in something opaque, of which a part is in one image and the rest in another.
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Stack> whole, first, second;
    const Bench bench{.width = 16, .height = 8};
    for (int i = 0; i < 16 * 8; ++i) {
        Stack all, a, b;
        float z = 0.5F;
        const int count = 1 + static_cast<int>(4 * unit(random));
        for (int k = 0; k < count; ++k) {
            z += 0.3F + unit(random);
            const float alpha = k + 1 < count ? 0.8F * unit(random) : 1;
            all.push_back(sample(z, alpha * unit(random), alpha));
            (alpha < 1 && unit(random) < 0.5F ? a : b).push_back(all.back());
        }
        whole.push_back(all);
        first.push_back(a);
        second.push_back(b);
    }
    const auto of = [](const std::vector<Stack>& stacks) {
        return [&stacks](int x, int y) { return stacks[static_cast<std::size_t>(16 * y + x)]; };
    };
    ForeignPicture laid = bench.picture(of(first));
    lay_behind(laid, bench.picture(of(second)), "back.exr");
    const ForeignPicture deep = bench.picture(of(whole));
    ASSERT_EQ(laid.offsets, deep.offsets);
    EXPECT_EQ(laid.flattened().rgb, deep.flattened().rgb);
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield})
        EXPECT_EQ(bench.focus(laid, method).image.rgb, bench.focus(deep, method).image.rgb);
}

TEST(LayBehind, WhatIsNearerThanTheFrontIsLeftOutAndCounted) {
    const Bench bench{.width = 10, .height = 1};
    ForeignPicture front = bench.picture([](int, int) { return Stack{sample(2, 0.5F)}; });
    // Two of ten are much nearer; one is nearer by less than noise on a slope.
    const ForeignPicture back = bench.picture([](int x, int) {
        return Stack{sample(x < 2 ? 1 : x == 2 ? 1.95F : 3, 0.1F)};
    });
    const LaidBehind laid = lay_behind(front, back, "back.exr");
    EXPECT_DOUBLE_EQ(laid.nearer_share, 0.2);
    EXPECT_EQ(laid.samples, 7U);
    EXPECT_EQ(front.stack(0, 0).size(), 1U);
}

TEST(LayBehind, WhereTheBackShowsNothingThereIsNothing) {
    const Bench bench{.width = 6, .height = 1};
    const auto card = [](int x, int) { return x < 4 ? Stack{sample(1, 0.9F)} : Stack{}; };
    // The first back image has a surface in one column and shows the card itself in another. The second one
    // ends in the surface of the first, or shows a veil.
    ForeignPicture front = bench.picture(card);
    EXPECT_FALSE(front.is_nothing_behind(0));
    lay_behind(front, bench.picture([&](int x, int) {
        return x == 0 ? Stack{sample(3, 0.5F)} : x == 1 ? Stack{sample(1, 0.9F)} : Stack{};
    }),
               "b");
    const auto ends = [&] {
        std::vector<bool> out;
        for (std::size_t x = 0; x < 6; ++x) out.push_back(front.is_nothing_behind(x));
        return out;
    };
    EXPECT_EQ(ends(), (std::vector<bool>{false, false, true, true, false, false}));
    EXPECT_EQ(transmittance_behind(front.stack_of(2), front.is_nothing_behind(2)), 1);
    EXPECT_EQ(transmittance_behind(front.stack_of(0), front.is_nothing_behind(0)), 0);
    lay_behind(front, bench.picture([&](int x, int) {
        return x == 2 ? Stack{sample(4, 0.5F)} : x == 3 ? Stack{sample(4, 0.25F, 0.25F)} : Stack{};
    }),
               "c");
    EXPECT_EQ(ends(), (std::vector<bool>{true, true, false, true, false, false}));
    EXPECT_EQ(transmittance_behind(front.stack_of(3), front.is_nothing_behind(3)), 0.75);
}

TEST(LayBehind, ThreeImagesLieInTheirOrder) {
    const Bench bench{.width = 4, .height = 1};
    ForeignPicture front = bench.picture([](int, int) { return Stack{sample(1, 0.9F)}; });
    lay_behind(front, bench.picture([](int, int) { return Stack{sample(2, 0.5F)}; }), "b");
    // The third shows at one pixel what the second has already.
    lay_behind(front, bench.picture([](int x, int) { return Stack{sample(x == 0 ? 2 : 4, 0.1F)}; }), "c");
    EXPECT_EQ(front.stack(0, 0).size(), 2U);
    ASSERT_EQ(front.stack(1, 0).size(), 3U);
    EXPECT_FLOAT_EQ(front.stack(1, 0)[2].inverse_z, 0.25F);
}

TEST(LayBehind, ATranslucentSurfaceThatBothShowCountsOnce) {
    const Bench bench{.width = 3, .height = 1};
    const auto veil = [&](std::uint32_t id) {
        return bench.picture([id](int, int) {
            StackSample s = sample(2, 0.1F, 0.5F);
            s.id = id;
            return Stack{s};
        });
    };
    for (const std::uint32_t id : {0U, 7U, 8U}) {
        ForeignPicture front = veil(7);
        lay_behind(front, veil(id), "back.exr");
        // Of two objects at one depth, both are there.
        EXPECT_EQ(front.stack(1, 0).size(), id == 8 ? 2U : 1U) << id;
    }
}

TEST(LayBehind, TheNamesOfBothCryptomattesAreKept) {
    const Bench bench{.width = 3, .height = 1};
    const auto named = [&](const std::string& manifest) {
        ForeignPicture p = bench.picture([](int, int) { return Stack{sample(2, 0.1F, 0.5F)}; });
        p.channels.matte = Cryptomatte{"CryptoObject", {}, manifest};
        return p;
    };
    ForeignPicture front = named(R"({"card":"0000000a"})");
    lay_behind(front, named(R"({"card":"0000000b","wall":"0000000c"})"), "back.exr");
    const auto objects = manifest_objects(front.channels.matte->manifest);
    ASSERT_TRUE(objects);
    ASSERT_EQ(objects->size(), 2U);
    EXPECT_EQ((*objects)[0].id, 10U);
    EXPECT_EQ((*objects)[1].name, "wall");
    EXPECT_EQ((*objects)[1].id, 12U);
    // A manifest that cannot be read stays as it is.
    front = named("not JSON");
    lay_behind(front, named(R"({"wall":"0000000c"})"), "back.exr");
    EXPECT_EQ(front.channels.matte->manifest, "not JSON");
}

TEST(LayBehind, StoresThePixelsOfBothWhereTheFrontIsKnown) {
    const Bench narrow{.width = 4, .height = 2}, wide{.width = 4, .height = 2, .margin_px = 3};
    const auto grey = [](int, int) { return Stack{sample(1, 0.9F)}; };
    const ForeignPicture back = wide.picture([](int, int) { return Stack{sample(2, 0.5F)}; });
    // The front ends at the border on all sides, so what it shows beyond is unknown.
    ForeignPicture front = narrow.picture(grey);
    lay_behind(front, back, "b");
    EXPECT_EQ(front.x_begin, 0);
    EXPECT_EQ(front.y_end, 2);
    EXPECT_EQ(front.stack(0, 0).size(), 2U);
    // The front stores the left half only, so nothing of it is on the right.
    front = narrow.picture(grey);
    front.x_end = 2;
    front.samples.resize(4);
    front.offsets.resize(5);
    lay_behind(front, back, "b");
    EXPECT_EQ(front.x_begin, 0);
    EXPECT_EQ(front.x_end, 7);
    EXPECT_EQ(front.y_begin, 0);
    EXPECT_EQ(front.stack(1, 1).size(), 2U);
    EXPECT_EQ(front.stack(6, 1).size(), 1U);
    // A front that is larger than the back stores its own pixels.
    front = wide.picture(grey);
    lay_behind(front, narrow.picture([](int, int) { return Stack{sample(2, 0.5F)}; }), "b");
    EXPECT_EQ(front.x_begin, -3);
    EXPECT_EQ(front.stack(-3, 4).size(), 1U);
    EXPECT_EQ(front.stack(0, 0).size(), 2U);
}

TEST(LayBehind, OtherRastersAndViewsAreRefused) {
    const Bench bench{.width = 8, .height = 4};
    const auto grey = [](int, int) { return Stack{sample(1, 0.5F)}; };
    const auto refused = [&](const ForeignPicture& back, const std::string& what) {
        ForeignPicture front = bench.picture(grey);
        try {
            lay_behind(front, back, "back.exr");
            ADD_FAILURE() << what;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            EXPECT_NE(std::string(e.what()).find("back.exr"), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
        }
    };
    refused(Bench{.width = 9, .height = 4}.picture(grey), "9x4");
    ForeignPicture other = bench.picture(grey);
    other.camera.film_distance_mm *= 1.01;
    refused(other, "view");
}

}  // namespace
}  // namespace postlens::test::lay_behind_test
