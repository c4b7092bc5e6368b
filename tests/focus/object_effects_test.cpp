// Holdouts, objects that stay sharp, objects whose focus is moved, and how objects are chosen.
#include "focus/foreign/object_effects.h"

#include <array>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "pictures/foreign/cryptomatte.h"
#include "tests/focus/level_radius.h"
#include "tests/support/edge_response.h"
#include "tests/support/refusal.h"
#include "tests/support/stack_bench.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::object_effects_test {
namespace {

using Bench = StackBench;

constexpr int x0 = 40;
constexpr double near_px = -8, wall_px = 6;

/// A red half-plane called "card", with a CoC radius of 8 px in front of the focus, before a blue wall.
class ObjectEffectsTest : public testing::Test {
  protected:
    [[nodiscard]] ForeignPicture card() const {
        ForeignPicture p = bench_.picture([&](int x, int) {
            const StackSample wall{bench_.inverse_z(wall_px), 0, 0.25F, 1, 1, cryptomatte_id("wall")};
            if (x < x0) return Stack{wall};
            return Stack{{bench_.inverse_z(near_px), 1, 0.5F, 0, 1, cryptomatte_id("card")}, wall};
        });
        p.channels.matte = Cryptomatte{"CryptoObject", {}, R"({"card":"1","wall":"2"})"};
        return p;
    }
    [[nodiscard]] FocusResult focused(const ObjectEffects& effects, FocusMethod method) const {
        ForeignPicture p = card();
        apply_object_effects(p, effects, bench_.inverse_focus_per_m);
        return bench_.focus(p, method);
    }
    const Bench bench_{.width = 80, .height = 4, .margin_px = 40};
    const ObjectChoice by_name_{"--option", "card"};
};

TEST_F(ObjectEffectsTest, AHoldoutHidesSharplyAndIsNotShown) {
    for (const FocusMethod method : {FocusMethod::pinhole, FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusResult r = focused({.holdouts = {by_name_}}, method);
        ASSERT_FALSE(r.image.alpha.empty());
        for (int x = 0; x < bench_.width; ++x) {
            const float shown = x < x0 ? 1 : 0;
            EXPECT_NEAR(alpha(r.image, x, 1), shown, 1e-5) << x;
            EXPECT_NEAR(value(r.image, x, 1, 0), 0, 1e-5) << x;
            EXPECT_NEAR(value(r.image, x, 1, 2), shown, 1e-5) << x;
        }
    }
}

// Behind the card, the image has nothing. What is estimated there from the wall is as invisible as the wall.
TEST_F(ObjectEffectsTest, WhatIsEstimatedFromAHoldoutIsNotShown) {
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        ForeignPicture p = bench_.picture([&](int x, int) {
            return x < x0 ? Stack{{bench_.inverse_z(wall_px), 0, 0.25F, 1, 1, cryptomatte_id("wall")}}
                          : Stack{{bench_.inverse_z(near_px), 1, 0.5F, 0, 1, cryptomatte_id("card")}};
        });
        p.channels.matte = Cryptomatte{"CryptoObject", {}, "{}"};
        apply_object_effects(p, {.holdouts = {{"--holdout", "wall"}}}, bench_.inverse_focus_per_m);
        const FocusResult r = bench_.focus(p, method);
        for (int x = 0; x < bench_.width; ++x) {
            const double front = edge_response((x + 0.5 - x0) / level_radius(near_px));
            EXPECT_NEAR(value(r.image, x, 1, 0), front, method == FocusMethod::layers ? 1e-5 : 0.05) << x;
            EXPECT_NEAR(alpha(r.image, x, 1), value(r.image, x, 1, 0), 1e-5) << x;
            EXPECT_NEAR(value(r.image, x, 1, 2), 0, 1e-5) << x;
        }
    }
}

TEST_F(ObjectEffectsTest, AnObjectThatIsKeptSharpIsItsPixels) {
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusResult r = focused({.sharp = {by_name_}}, method);
        for (int x = 0; x < bench_.width; ++x) {
            EXPECT_NEAR(value(r.image, x, 1, 0), x < x0 ? 0 : 1, 1e-5) << x;
            EXPECT_NEAR(value(r.image, x, 1, 2), x < x0 ? 1 : 0, 1e-5) << x;
        }
    }
}

/// A flat picture, which does not say what is behind the card: the card with this CoC radius before the wall.
ForeignPicture flat_card(const StackBench& bench, double card_px) {
    ForeignPicture p = bench.picture([&](int x, int) {
        return x < x0 ? Stack{{bench.inverse_z(wall_px), 0, 0.25F, 1, 1, cryptomatte_id("wall")}}
                      : Stack{{bench.inverse_z(card_px), 1, 0.5F, 0, 1, cryptomatte_id("card")}};
    });
    p.channels.matte = Cryptomatte{"CryptoObject", {}, R"({"card":"1","wall":"2"})"};
    return p;
}

TEST_F(ObjectEffectsTest, AnOffsetBehindTheCameraIsToldAndStaysBeforeIt) {
    for (const double before_camera_m : {0.1, -0.1}) {
        ForeignPicture p = flat_card(bench_, near_px);
        const double depth_m = 1 / static_cast<double>(bench_.inverse_z(near_px));
        apply_object_effects(p, {.offsets = {{{"--focus-offset", "card"}, before_camera_m - depth_m}}},
                             bench_.inverse_focus_per_m);
        for (const StackSample& s : p.samples) {
            if (s.id != cryptomatte_id("card")) continue;
            EXPECT_NEAR(s.moved_inverse_z, before_camera_m > 0 ? 1 / before_camera_m : 1000, 1e-3);
        }
        ASSERT_EQ(p.repairs.size(), before_camera_m > 0 ? 0 : 1);
        if (before_camera_m > 0) continue;
        EXPECT_EQ(p.repairs[0].code, "offset");
        EXPECT_NE(p.repairs[0].text.find("100 % of card behind the camera"), std::string::npos)
            << p.repairs[0].text;
        EXPECT_EQ(p.repairs[0].share, 1);
    }
}

// What is estimated behind an object is decided by depths, whatever the circles are.
TEST_F(ObjectEffectsTest, TheWallOfAFlatPictureStaysBehindWithAnyCircles) {
    const auto offset = [&](const std::string& object, double from_px, double to_px) {
        return ObjectEffects::Offset{{"--focus-offset", object},
                                     1 / static_cast<double>(bench_.inverse_z(to_px)) -
                                         1 / static_cast<double>(bench_.inverse_z(from_px))};
    };
    struct Case {
        double card_px;  ///< of its own depth
        ObjectEffects effects;
        double circle_px;  ///< of the card's blur
    };
    const Case cases[] = {
        {near_px, {.sharp = {{"--keep-sharp", "wall"}}}, near_px},
        {3, {.sharp = {{"--keep-sharp", "wall"}}}, 3},  // both behind the focus: the wall comes nearer
        {3, {.sharp = {{"--keep-sharp", "card"}}}, 0},
        {near_px, {.offsets = {offset("wall", wall_px, -12)}}, near_px},
        {near_px, {.offsets = {offset("card", near_px, 9)}}, 9},
        {near_px, {.offsets = {offset("card", near_px, 5), offset("wall", wall_px, -7)}}, 5},
    };
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        Bench bench = bench_;
        bench.settings.views = 1024;
        for (const Case& c : cases) {
            ForeignPicture p = flat_card(bench, c.card_px);
            apply_object_effects(p, c.effects, bench.inverse_focus_per_m);
            const Image image = bench.focus(p, method).image;
            for (int x = 0; x < bench.width; ++x) {
                const double front = c.circle_px == 0
                                         ? (x < x0 ? 0 : 1)
                                         : edge_response((x + 0.5 - x0) / level_radius(c.circle_px));
                const double tolerance = method == FocusMethod::layers ? 1e-5 : 0.02;
                EXPECT_NEAR(value(image, x, 1, 0), front, tolerance) << &c - cases << " at " << x;
                EXPECT_NEAR(value(image, x, 1, 2), 1 - front, tolerance) << &c - cases << " at " << x;
            }
        }
    }
}

TEST_F(ObjectEffectsTest, AnOffsetGivesTheCirclesOfTheOtherDepth) {
    // From 8 px in front of the focus to 3 px in front of it.
    const double moved_px = -3;
    const double metres = 1 / static_cast<double>(bench_.inverse_z(moved_px)) -
                          1 / static_cast<double>(bench_.inverse_z(near_px));
    const FocusResult r = focused({.offsets = {{by_name_, metres}}}, FocusMethod::layers);
    for (int x = 0; x < bench_.width; ++x) {
        const double front = edge_response((x + 0.5 - x0) / level_radius(moved_px));
        EXPECT_NEAR(value(r.image, x, 1, 0), front, 1e-5) << x;
    }
}

TEST_F(ObjectEffectsTest, WhatAnObjectHidesStaysWhereItsFocusGoes) {
    // With the circles of something behind the wall, the card still hides it.
    const double metres =
        1 / static_cast<double>(bench_.inverse_z(9)) - 1 / static_cast<double>(bench_.inverse_z(near_px));
    ForeignPicture p = card();
    const Image before = p.flattened();
    apply_object_effects(p, {.offsets = {{by_name_, metres}}}, bench_.inverse_focus_per_m);
    EXPECT_EQ(p.flattened().rgb, before.rgb);
    const FocusResult r = bench_.focus(p, FocusMethod::layers);
    EXPECT_NEAR(value(r.image, 79, 1, 0), 1, 1e-5);
    EXPECT_NEAR(value(r.image, 79, 1, 2), 0, 1e-5);
}

TEST_F(ObjectEffectsTest, AMaskChoosesWhatANameDoes) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "mask.exr").string();
    Image mask(bench_.width, bench_.height);
    for (int y = 0; y < bench_.height; ++y) {
        for (int x = x0; x < bench_.width; ++x) {
            for (std::size_t c = 0; c < 3; ++c) mask.pixel(x, y)[c] = 1;
        }
    }
    write_image(path, mask);
    // The card is stored beyond the raster, where its outermost values continue the mask.
    const Image one = focused({.holdouts = {{"--holdout", path}}}, FocusMethod::layers).image,
                other = focused({.holdouts = {by_name_}}, FocusMethod::layers).image;
    EXPECT_EQ(one.rgb, other.rgb);
    EXPECT_EQ(one.alpha, other.alpha);
}

TEST_F(ObjectEffectsTest, AShareOfAMaskDividesASampleInTwo) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "mask.exr").string();
    const Bench small{.width = 4, .height = 1};
    Image mask(4, 1);
    for (int x = 0; x < 4; ++x) mask.rgb[static_cast<std::size_t>(3 * x) + 1] = 0.3F * static_cast<float>(x);
    write_image(path, mask);
    ForeignPicture p = small.picture([](int, int) {
        return Stack{{0.5F, 0.6F, 0.3F, 0, 0.75F, 3}, {0.25F, 0, 0, 1}};
    });
    const Image before = p.flattened();
    const std::vector<std::uint8_t> chosen = choose_samples(p, {"--matte", path});
    ASSERT_EQ(chosen.size(), p.samples.size());
    EXPECT_EQ(chosen, (std::vector<std::uint8_t>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}));
    EXPECT_FLOAT_EQ(p.samples[2].alpha, 0.1F);
    for (std::size_t i = 0; i < before.rgb.size(); ++i)
        EXPECT_NEAR(p.flattened().rgb[i], before.rgb[i], 1e-6);
    EXPECT_TRUE(p.flattened().alpha.empty());
}

TEST_F(ObjectEffectsTest, MasksAreCoveragesAndThoseOfTwoFilesAddUp) {
    const TemporaryFolder folder;
    const Bench small{.width = 4, .height = 1};
    const auto mask_file = [&](const std::string& name, std::array<float, 4> of) {
        Image mask(4, 1);
        for (std::size_t i = 0; i < mask.rgb.size(); ++i) mask.rgb[i] = of[i / 3];
        const std::string path = (folder.path() / name).string();
        write_image(path, mask);
        return path;
    };
    constexpr std::array<float, 4> alphas{1, 0.36F, 0.8F, 1};
    const auto left_of = [&](const std::vector<std::string>& files) {
        ForeignPicture p = small.picture([&](int x, int) {
            const float a = alphas[static_cast<std::size_t>(x)];
            return Stack{{0.5F, a, a, a, a}};
        });
        ObjectEffects effects;
        for (const std::string& file : files) effects.holdouts.push_back({"--holdout", file});
        apply_object_effects(p, effects, bench_.inverse_focus_per_m);
        return small.focus(p, FocusMethod::pinhole).image;
    };
    // The object's own coverage takes all of it away, also where it is translucent.
    const std::string own = mask_file("own.exr", {1, 0.36F, 0.8F, 0}),
                      half = mask_file("half.exr", {0.5F, 0.18F, 0.3F, 1}),
                      other = mask_file("other.exr", {0.5F, 0.18F, 0.2F, 1});
    const auto expect = [&](const std::vector<std::string>& files, std::array<float, 4> covered) {
        const Image image = left_of(files);
        for (int x = 0; x < 4; ++x) {
            EXPECT_NEAR(alpha(image, x, 0), covered[static_cast<std::size_t>(x)], 1e-6)
                << files.size() << " at " << x;
            EXPECT_NEAR(value(image, x, 0, 1), covered[static_cast<std::size_t>(x)], 1e-6) << x;
        }
    };
    expect({own}, {0, 0, 0, 1});
    expect({half}, {0.5F, 0.18F, 0.5F, 0});
    expect({half, other}, {0, 0, 0.3F, 0});
    expect({half, half}, {0.5F, 0.18F, 0.5F, 0});
    expect({half, other, half}, {0, 0, 0.3F, 0});
}

TEST_F(ObjectEffectsTest, ASoftMaskHoldsOutItsShareWhateverTheBlur) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "mask.exr").string();
    Bench bench{.width = 32, .height = 16, .margin_px = 16};
    bench.settings.views = 1024;
    Image mask(bench.width, bench.height);
    for (std::size_t i = 0; i < mask.rgb.size(); ++i) mask.rgb[i] = static_cast<float>(i / 3 % 32) / 32;
    write_image(path, mask);
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        ForeignPicture p = bench.picture([&](int, int) {
            return Stack{{bench.inverse_z(6), 0.5F, 0.5F, 0.5F, 1}};
        });
        apply_object_effects(p, {.holdouts = {{"--holdout", path}}}, bench.inverse_focus_per_m);
        const Image image = bench.focus(p, method).image;
        for (int x = 8; x < 24; ++x)
            EXPECT_NEAR(alpha(image, x, 8), 1 - x / 32.0, method == FocusMethod::layers ? 0.01 : 0.02) << x;
    }
}

TEST_F(ObjectEffectsTest, NumbersOfAnIdChannelNameObjectsToo) {
    for (const bool whole : {true, false}) {
        ForeignPicture p = bench_.picture([&](int x, int) {
            return Stack{{1, 0, 0, 0, 1, surface_id(x < x0 ? 7 : 8, whole)}};
        });
        p.channels.id = "id";
        if (whole) {
            for (StackSample& s : p.samples) s.id = s.id == surface_id(7, true) ? 7 : 8;
        }
        const std::vector<float> pixels = choose_pixels(p, {"--matte", "7"});
        for (int x = 0; x < bench_.width; ++x)
            EXPECT_EQ(pixels[static_cast<std::size_t>(x)], x < x0 ? 1 : 0) << x;
    }
}

// Some programs number their objects; their ids are no hashes of the names.
TEST_F(ObjectEffectsTest, AManifestStatesTheIdsOfNames) {
    ForeignPicture p = bench_.picture([&](int x, int) {
        return Stack{{1, 0, 0, 0, 1, x < x0 ? 0x3f800001U : cryptomatte_id("card")}};
    });
    p.channels.matte = Cryptomatte{"CryptoObject", {}, R"({"card":"3f800001"})"};
    const std::vector<float> pixels = choose_pixels(p, {"--matte", "card"});
    for (int x = 0; x < bench_.width; ++x)
        EXPECT_EQ(pixels[static_cast<std::size_t>(x)], x < x0 ? 1 : 0) << x;
}

TEST_F(ObjectEffectsTest, WhatNoPixelShowsIsRefusedWithTheNamesThereAre) {
    ForeignPicture p = card();
    const auto refused = [&](const std::string& object, ExitCode code, const std::string& text) {
        expect_refused([&] { (void)choose_samples(p, {"--holdout", object}); }, code, text);
    };
    refused("cup", ExitCode::wrong_arguments,
            "cup; expected a name of the Cryptomatte CryptoObject: card, wall");
    refused("", ExitCode::wrong_arguments, "--holdout");
    refused("none.png", ExitCode::invalid_input, "none.png");
    p.channels.matte.reset();
    refused("cup", ExitCode::wrong_arguments, "no ids");
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "mask.exr").string();
    write_image(path, Image(3, 3));
    refused(path, ExitCode::invalid_input, "3x3");
}

}  // namespace
}  // namespace postlens::test::object_effects_test
