// Faults that depth-of-field filters of other programs are known for, on pictures that bring them about.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>

#include "focus/foreign_focus.h"
#include "pictures/stacks/lay_behind.h"
#include "tests/focus/level_radius.h"
#include "tests/support/edge_response.h"
#include "tests/support/stack_bench.h"

namespace postlens::test::foreign_faults_test {
namespace {

using Bench = StackBench;

constexpr FocusMethod methods[] = {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield};

TEST(ForeignFaults, DepthEdgesInsideABlurredForegroundDoNotShow) {
    // Two halves of one colour at depths whose circles differ by 2 px: no line where they meet.
    const Bench bench{.width = 60, .height = 40, .margin_px = 20};
    const ForeignPicture p = bench.picture([&](int x, int) {
        return Stack{{bench.inverse_z(x < 30 ? -8 : -10), 0.5F, 0.25F, 0.75F}};
    });
    for (const FocusMethod method : methods) {
        const FocusResult r = bench.focus(p, method);
        for (int x = 0; x < bench.width; ++x) ASSERT_NEAR(value(r.image, x, 20, 1), 0.25, 2e-6) << x;
    }
}

TEST(ForeignFaults, WideRastersHaveNoSeams) {
    // Columns of a raster beyond 4096 px are those of the same columns in a narrow one.
    constexpr int columns = 4300, shift = 4096 - 64;
    const auto stack_at = [](const Bench& bench, int x, int y) {
        const bool near = (x / 23 + y / 5) % 3 == 0;
        const float v = 0.25F + 0.02F * static_cast<float>((x * 7 + y * 3) % 20);
        return Stack{{bench.inverse_z(near ? -5 : 4), v, 1 - v, 0.5F}};
    };
    const Bench wide{.width = columns, .height = 12};
    const Bench narrow{.width = 128, .height = 12, .margin_px = 0};
    const ForeignPicture whole = wide.picture([&](int x, int y) { return stack_at(wide, x, y); });
    const ForeignPicture part = narrow.picture([&](int x, int y) { return stack_at(narrow, x + shift, y); });
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers}) {
        const Image a = wide.focus(whole, method).image, b = narrow.focus(part, method).image;
        for (int y = 0; y < 12; ++y) {
            // Away from the narrow raster's own border by the two circles that reach a pixel.
            for (int x = 24; x < 104; ++x)
                ASSERT_NEAR(value(a, x + shift, y, 0), value(b, x, y, 0), 1e-5) << x << "," << y;
        }
    }
}

TEST(ForeignFaults, TheFocalLineHasNeitherHalosNorBands) {
    // A floor of one colour, from 12 px in front of the focus to 12 px behind it.
    const Bench bench{.width = 16, .height = 96, .margin_px = 24};
    const ForeignPicture p = bench.picture([&](int, int y) {
        return Stack{{bench.inverse_z((y - 48) / 4.0), 0.5F, 0.25F, 0.75F}};
    });
    for (const FocusMethod method : methods) {
        const FocusResult r = bench.focus(p, method);
        for (int y = 12; y < 84; ++y) ASSERT_NEAR(value(r.image, 8, y, 1), 0.25, 2e-6) << y;
    }
}

TEST(ForeignFaults, WhatIsSharpHasNoHaloOfTheBlurredThingsAround) {
    // A card in focus before a blurred wall keeps its colour up to its edge.
    const Bench bench{.width = 80, .height = 8, .margin_px = 20};
    const ForeignPicture p = bench.picture([&](int x, int) {
        const StackSample wall{bench.inverse_z(9), 0, 1, 0};
        if (x < 40) return Stack{wall};
        return Stack{{bench.inverse_z(0), 1, 0, 0}, wall};
    });
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        const FocusResult r = bench.focus(p, method);
        for (int x = 0; x < 80; ++x) {
            EXPECT_NEAR(value(r.image, x, 4, 0), x < 40 ? 0 : 1, 1e-5) << x;
            EXPECT_NEAR(value(r.image, x, 4, 1), x < 40 ? 1 : 0, 1e-5) << x;
        }
    }
}

TEST(ForeignFaults, GlassInFocusDoesNotKeepWhatIsBehindItSharp) {
    // A pane of alpha 0.2 in focus before the edge of something far: the edge is blurred behind the pane.
    const Bench bench{.width = 80, .height = 8, .margin_px = 20};
    const ForeignPicture p = bench.picture([&](int x, int) {
        return Stack{{bench.inverse_z(0), 0.2F, 0, 0, 0.2F},
                     {bench.inverse_z(8), 0, x < 40 ? 1.0F : 0.0F, 0}};
    });
    FocusResult r = bench.focus(p, FocusMethod::layers);
    for (int x = 0; x < 80; ++x) {
        const double far = 1 - edge_response((x + 0.5 - 40) / level_radius(8));
        EXPECT_NEAR(value(r.image, x, 4, 0), 0.2, 1e-5) << x;
        EXPECT_NEAR(value(r.image, x, 4, 1), 0.8 * far, 1e-5) << x;
    }
}

TEST(ForeignFaults, GlowAndThinFogDimNothing) {
    // 200 samples that shine and cover nothing, or that cover 1e-5 each, before a wall.
    const Bench bench{.width = 16, .height = 2, .margin_px = 12};
    const auto wall_behind = [&](float alpha) {
        return bench.picture([&](int, int) {
            Stack stack;
            for (int i = 0; i < 200; ++i)
                stack.push_back({bench.inverse_z(-8 + 0.04 * i), 1e-3F, 0, 0, alpha});
            stack.push_back({bench.inverse_z(4), 0, 1, 0});
            return stack;
        });
    };
    const ForeignPicture glow = wall_behind(0), fog = wall_behind(1e-5F);
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers}) {
        const Image g = bench.focus(glow, method).image, f = bench.focus(fog, method).image;
        EXPECT_NEAR(value(g, 8, 1, 0), 0.2, 1e-4);
        EXPECT_NEAR(value(g, 8, 1, 1), 1, 1e-4);
        EXPECT_NEAR(value(f, 8, 1, 1), std::pow(1 - 1e-5, 200), 1e-4);
    }
}

TEST(ForeignFaults, ATransparentBackgroundStaysTransparent) {
    // A blurred card before nothing: premultiplied colour and alpha have the same edge, with no dark fringe.
    const Bench bench{.width = 80, .height = 8, .margin_px = 20};
    const ForeignPicture p = bench.picture([&](int x, int) {
        return x < 40 ? Stack{} : Stack{{bench.inverse_z(-8), 0.5F, 0.25F, 0.75F}};
    });
    for (const FocusMethod method : methods) {
        const FocusResult r = bench.focus(p, method);
        for (int x = 0; x < 80; ++x) {
            ASSERT_NEAR(value(r.image, x, 4, 0), 0.5 * static_cast<double>(alpha(r.image, x, 4)), 3e-6) << x;
            const bool at_edge = x >= 30 && x <= 50;
            if (!at_edge) {
                ASSERT_NEAR(alpha(r.image, x, 4), x < 30 ? 0 : 1, 1e-6) << x;
            }
        }
    }
}

TEST(ForeignFaults, WhatEndsBehindABlurredBarIsNotContinued) {
    // A blurred bar over nothing. A second image shows a card in focus, which ends behind the bar. Below the
    // card, the edge of the bar has the same alpha in all rows.
    constexpr int card_end = 12;
    const Bench bench{.width = 64, .height = 32, .margin_px = 12};
    const auto card = [&](int, int y) {
        return y < card_end ? Stack{{bench.inverse_z(0), 0, 1, 0}} : Stack{};
    };
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        ForeignPicture p = bench.picture([&](int x, int y) {
            return x < 32 ? Stack{{bench.inverse_z(-8), 1, 0, 0}} : card(x, y);
        });
        lay_behind(p, bench.picture(card), "back.exr");
        const Image image = bench.focus(p, method).image;
        for (int x = 0; x < bench.width; ++x) {
            for (int y = card_end; y < 24; ++y) {
                ASSERT_NEAR(value(image, x, y, 1), 0, 1e-6) << x << "," << y;
                ASSERT_NEAR(alpha(image, x, y), alpha(image, x, 24), 1e-6) << x << "," << y;
            }
            ASSERT_NEAR(alpha(image, x, card_end - 1), 1, 1e-6) << x;
        }
        EXPECT_NEAR(alpha(image, 32, 24), 0.5, 0.1);
    }
}

TEST(ForeignFaults, BlurredInTransparencyHasAlpha) {
    // All pixels of the raster are opaque, but a border of empty pixels, a holdout behind a blurred bar or
    // the empty space behind it shows at blurred edges. The picture is white, so colour and alpha are equal.
    const Bench bench{.width = 40, .height = 12, .margin_px = 12};
    const StackSample bar{bench.inverse_z(-6), 1, 1, 1}, wall{bench.inverse_z(6), 1, 1, 1};
    StackSample held = wall;
    held.holdout = true;
    held.r = held.g = held.b = 0;
    const ForeignPicture border = bench.picture(
        [&](int x, int y) { return x >= 0 && x < 40 && y >= 0 && y < 12 ? Stack{wall} : Stack{}; });
    const ForeignPicture holdout = bench.picture([&](int x, int) {
        return x < 20 ? Stack{bar, held} : Stack{wall};
    });
    const auto bar_and_wall = [&](int x, int) { return Stack{x < 20 ? bar : wall}; };
    ForeignPicture open = bench.picture(bar_and_wall);
    lay_behind(open, bench.picture([&](int x, int) { return x < 20 ? Stack{} : Stack{wall}; }), "back.exr");
    for (const FocusMethod method : methods) {
        for (const ForeignPicture* p :
             std::initializer_list<const ForeignPicture*>{&border, &holdout, &open}) {
            if (method == FocusMethod::scatter && p != &border) continue;  // it shows no hidden surfaces
            const Image image = bench.focus(*p, method).image;
            ASSERT_FALSE(image.alpha.empty());
            float least = 1;
            for (int x = 0; x < 40; ++x) {
                ASSERT_NEAR(value(image, x, 6, 0), alpha(image, x, 6), 1e-5) << x;
                least = std::min(least, alpha(image, x, 6));
            }
            EXPECT_LT(least, 0.7);
        }
    }
}

TEST(ForeignFaults, AWideApertureSeesAsFarBehindAnEdgeAsItIsWide) {
    // A near bar in front of a wall in focus. The aperture is three times as wide as tall. Across the bar's
    // edge, the edge is blurred as by a round aperture of that width.
    for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
        Bench wide{.width = 96, .height = 8, .margin_px = 24};
        wide.settings.impulse.squeeze = 1.0 / 3;
        wide.settings.views = 1024;
        const ForeignPicture p = wide.picture([&](int x, int) {
            return x < 48 ? Stack{{wide.inverse_z(-5), 1, 0, 0}} : Stack{{wide.inverse_z(0), 0, 1, 0}};
        });
        const Image image = wide.focus(p, method).image;
        ASSERT_TRUE(image.alpha.empty());
        for (int x = 0; x < 96; ++x) {
            const double bar = 1 - edge_response((x + 0.5 - 48) / 15);
            ASSERT_NEAR(value(image, x, 4, 0), bar, 0.02) << x;
            ASSERT_NEAR(value(image, x, 4, 1), 1 - bar, 0.02) << x;
        }
    }
}

TEST(ForeignFaults, TheLargestFloatsStayFinite) {
    const float largest = std::numeric_limits<float>::max();
    const Bench bench{.width = 16, .height = 4};
    const ForeignPicture p = bench.picture([&](int x, int) {
        return Stack{{bench.inverse_z(3), largest, -largest, x < 8 ? largest : 0.0F}};
    });
    for (const FocusMethod method : methods) {
        for (const float v : bench.focus(p, method).image.rgb) ASSERT_TRUE(std::isfinite(v));
    }
}

TEST(ForeignFaults, ASkyWithoutAlphaIsNoDarkFringe) {
    // A blurred card before a translucent background that is the same everywhere: before a sky whose pixels
    // have a colour and no alpha, and before veils. The background is in the picture also behind the card, or
    // only beside it.
    const Bench bench{.width = 60, .height = 24, .margin_px = 20};
    for (const double behind_px : {0.0, 3.0}) {
        for (const float behind_alpha : {0.0F, 0.1F, 0.6F}) {
            for (const bool deep : {false, true}) {
                const ForeignPicture p = bench.picture([&](int x, int) {
                    const StackSample far{bench.inverse_z(behind_px), 0, 0.5F, 0, behind_alpha};
                    const StackSample card{bench.inverse_z(-8), 1, 0.5F, 0};
                    if (x < 30) return Stack{far};
                    return deep ? Stack{card, far} : Stack{card};
                });
                for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
                    const Image image = bench.focus(p, method).image;
                    const double error = method == FocusMethod::layers ? 1e-5 : 0.04;
                    for (int x = 0; x < 60; ++x) {
                        const double card = edge_response((x + 0.5 - 30) / level_radius(-8));
                        const double covered = card + (1 - card) * static_cast<double>(behind_alpha);
                        ASSERT_NEAR(value(image, x, 12, 0), card, error) << behind_alpha << " " << x;
                        ASSERT_NEAR(value(image, x, 12, 1), 0.5, error) << behind_alpha << " " << x;
                        ASSERT_NEAR(alpha(image, x, 12), covered, error) << behind_alpha << " " << x;
                    }
                }
            }
        }
    }
}

TEST(ForeignFaults, AVeilBehindAnOpaqueCardDoesNotHideTheWallBesideIt) {
    // All surfaces have one colour. What stands behind the card is a veil, and beside them is a wall.
    const Bench bench{.width = 60, .height = 24, .margin_px = 20};
    const ForeignPicture p = bench.picture([&](int x, int) {
        const StackSample wall{bench.inverse_z(6), 0, 0.5F, 0};
        const StackSample card{bench.inverse_z(-8), 0, 0.5F, 0}, veil{bench.inverse_z(3), 0, 0.15F, 0, 0.3F};
        return x < 30 ? Stack{wall} : Stack{card, veil};
    });
    const Image image = bench.focus(p, FocusMethod::layers).image;
    EXPECT_TRUE(image.alpha.empty());
    for (int x = 0; x < 60; ++x) ASSERT_NEAR(value(image, x, 12, 1), 0.5, 1e-3) << x;
}

TEST(ForeignFaults, WhatTheBorderCutsIsNotTranslucentThere) {
    // A blurred bar that crosses the border, before a wall or before nothing, has at the border the edge that
    // it has in the middle.
    const Bench bench{.width = 60, .height = 40};
    for (const bool wall : {true, false}) {
        for (const double wall_px : {0.0, 5.0}) {
            const ForeignPicture p = bench.picture([&](int x, int) {
                if (x >= 20 && x < 40) return Stack{{bench.inverse_z(-6), 1, 0.5F, 0}};
                return wall ? Stack{{bench.inverse_z(wall_px), 0, 0.5F, 1}} : Stack{};
            });
            for (const FocusMethod method : {FocusMethod::layers, FocusMethod::lightfield}) {
                const Image image = bench.focus(p, method).image;
                const double error = method == FocusMethod::layers ? 2e-6 : 0.04;
                for (const int y : {0, 1, 4, 39}) {
                    for (int x = 0; x < 60; ++x) {
                        const double bar = edge_response((x + 0.5 - 20) / level_radius(-6)) +
                                           edge_response((40 - x - 0.5) / level_radius(-6)) - 1;
                        ASSERT_NEAR(value(image, x, y, 0), bar, error) << wall_px << " " << x << "," << y;
                        if (!wall) {
                            ASSERT_NEAR(alpha(image, x, y), bar, error) << x << "," << y;
                        }
                    }
                }
            }
        }
    }
}

TEST(ForeignFaults, WhatTheBorderDoesNotCutGainsNoLightThere) {
    // A light 2 px from the border and a card 4 px from it, before a wall. Further wall around the picture
    // changes nothing in it.
    Bench bench{.width = 48, .height = 32};
    const auto focus = [&](int margin_px, FocusMethod method) {
        bench.margin_px = margin_px;
        const ForeignPicture p = bench.picture([&](int x, int y) {
            if (x == 20 && y == 2) return Stack{{bench.inverse_z(-5), 80, 40, 20}};
            if (x >= 4 && x < 12 && y >= 10 && y < 20) return Stack{{bench.inverse_z(-8), 1, 0.5F, 0}};
            return Stack{{bench.inverse_z(0), 0.25F, 0.25F, 0.25F}};
        });
        return bench.focus(p, method).image;
    };
    const Image wide = focus(24, FocusMethod::layers), narrow = focus(0, FocusMethod::layers);
    for (std::size_t i = 0; i < wide.rgb.size(); ++i)
        ASSERT_NEAR(narrow.rgb[i], wide.rgb[i], 1e-5 * (1 + static_cast<double>(wide.rgb[i]))) << i;
}

}  // namespace
}  // namespace postlens::test::foreign_faults_test
