// Images of other programs through a lens: closed forms, conservation of light, surfaces that a flat image
// hides.
#include "focus/foreign_focus.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "focus/foreign/behind_fill.h"
#include "pictures/stacks/unmix_edges.h"
#include "tests/focus/level_radius.h"
#include "tests/support/edge_response.h"
#include "tests/support/refusal.h"
#include "tests/support/stack_bench.h"

namespace postlens::test::foreign_focus_test {
namespace {

using Bench = StackBench;

constexpr FocusMethod both[] = {FocusMethod::scatter, FocusMethod::layers};

TEST(ForeignFocus, HalfPlaneBeforeADeepBackgroundIsItsOwnEdge) {
    // The deep image also holds the background behind the half-plane. Samples are at the centres of pixels,
    // so the blurred edge has the values of a disc's edge at the centres.
    const Bench bench{.width = 80, .height = 4, .margin_px = 40};
    constexpr int x0 = 40;
    for (const double near_px : {-0.5, -3.3, -12.0}) {
        for (const double far_px : {0.0, 0.4, 3.0, 11.0, 25.0}) {
            const ForeignPicture p = bench.picture([&](int x, int) {
                const StackSample far{bench.inverse_z(far_px), 0, 0.25F, 1};
                if (x < x0) return Stack{far};
                return Stack{{bench.inverse_z(near_px), 1, 0.5F, 0}, far};
            });
            const FocusResult r = bench.focus(p, FocusMethod::layers);
            EXPECT_TRUE(r.image.alpha.empty());
            for (int x = 0; x < 80; ++x) {
                const double front = edge_response((x + 0.5 - x0) / level_radius(near_px));
                // The edge has the near surface's CoC, for any CoC of the background.
                ASSERT_NEAR(value(r.image, x, 1, 0), front, 2e-6) << near_px << " " << far_px << " " << x;
                ASSERT_NEAR(value(r.image, x, 1, 2), 1 - front, 2e-6) << near_px << " " << far_px << " " << x;
            }
        }
    }
}

TEST(ForeignFocus, HalfPlaneBeforeAnEvenBackgroundIsTheSameFromAFlatPicture) {
    // The background that the flat image hides is filled in from its surroundings.
    const Bench bench{.width = 80, .height = 24, .margin_px = 40};
    constexpr int x0 = 40;
    for (const double near_px : {-3.3, -12.0}) {
        for (const double far_px : {0.0, 3.0, 25.0}) {
            const ForeignPicture p = bench.picture([&](int x, int) {
                if (x < x0) return Stack{{bench.inverse_z(far_px), 0, 0.25F, 1}};
                return Stack{{bench.inverse_z(near_px), 1, 0.5F, 0}};
            });
            const FocusResult r = bench.focus(p, FocusMethod::layers);
            EXPECT_TRUE(r.image.alpha.empty());
            ASSERT_FALSE(r.warnings.empty());
            EXPECT_EQ(r.warnings.back().code, "uncovered");
            for (int x = 0; x < 80; ++x) {
                const double front = edge_response((x + 0.5 - x0) / level_radius(near_px));
                ASSERT_NEAR(value(r.image, x, 12, 0), front, 2e-6) << near_px << " " << far_px << " " << x;
            }
        }
    }
}

TEST(ForeignFocus, AlphaOfAHalfPlaneBeforeNothingIsItsEdge) {
    const Bench bench{.width = 80, .height = 24, .margin_px = 40};
    constexpr int x0 = 40;
    for (const double near_px : {-12.0, -3.3, 0.0, 7.0}) {
        const ForeignPicture p = bench.picture([&](int x, int) {
            if (x < x0) return Stack{};
            return Stack{{bench.inverse_z(near_px), 0.8F, 0.5F, 0}};
        });
        for (const FocusMethod method : both) {
            const FocusResult r = bench.focus(p, method);
            ASSERT_FALSE(r.image.alpha.empty());
            for (int x = 0; x < 80; ++x) {
                const double front = edge_response((x + 0.5 - x0) / level_radius(near_px));
                // Colours are premultiplied. Both methods leave the background empty.
                ASSERT_NEAR(alpha(r.image, x, 12), front, 3e-6) << near_px << " " << x;
                ASSERT_NEAR(value(r.image, x, 12, 0), 0.8 * front, 3e-6) << near_px << " " << x;
            }
        }
    }
}

TEST(ForeignFocus, WhatIsAlmostInfinitelyFarDoesNotMoveAlongWithNothing) {
    // The square has a CoC radius of 12.1 px. The empty background at infinity would have 12.5 px, but it has
    // no light, so none is missing behind the square.
    Bench bench{.width = 80, .height = 64, .margin_px = 40};
    bench.inverse_focus_per_m = 0.0125;
    const float z = bench.inverse_z(12.1);
    const auto spread = [&](const std::function<bool(int x, int y)>& is_there, FocusMethod method) {
        return bench
            .focus(bench.picture([&](int x, int y) {
                return is_there(x, y) ? Stack{{z, 0.8F, 0.5F, 0}} : Stack{};
            }),
                   method)
            .image;
    };
    for (const FocusMethod method : both) {
        const Image edge = spread([](int x, int) { return x >= 40; }, method);
        for (int x = 0; x < 80; ++x) {
            const double front = edge_response((x + 0.5 - 40) / level_radius(12.1));
            ASSERT_NEAR(alpha(edge, x, 32), front, 3e-6) << x;
            ASSERT_NEAR(value(edge, x, 32, 0), 0.8 * front, 3e-6) << x;
        }
        // Well within the CoC, the light of the whole small square arrives.
        const auto in_square = [](int x, int y) { return x >= 37 && x < 43 && y >= 29 && y < 35; };
        const Image square = spread(in_square, method);
        const double radius = level_radius(12.1), share = 36 / (std::numbers::pi * radius * radius);
        for (int x = 36; x < 44; ++x) EXPECT_NEAR(alpha(square, x, 32), share, 2e-3 * share) << x;
        double sum = 0;
        for (const float a : square.alpha) sum += static_cast<double>(a);
        EXPECT_NEAR(sum, 36, 1e-3);
    }
}

TEST(ForeignFocus, WhatIsSharpNearbyLeavesNoOutlineInWhatIsBlurred) {
    // A small square with a CoC radius of 11.9 px beside a sharp square. Empty pixels between them are close
    // to both.
    const Bench bench{.width = 80, .height = 64, .margin_px = 40};
    const auto in_square = [](int x, int y, int x0) { return x >= x0 && x < x0 + 6 && y >= 29 && y < 35; };
    const ForeignPicture p = bench.picture([&](int x, int y) {
        if (in_square(x, y, 30)) return Stack{{bench.inverse_z(-11.9), 1, 0, 0}};
        if (in_square(x, y, 46)) return Stack{{bench.inverse_z(0), 0, 1, 0}};
        return Stack{};
    });
    const double radius = level_radius(11.9), share = 36 / (std::numbers::pi * radius * radius);
    for (const FocusMethod method : both) {
        const Image image = bench.focus(p, method).image;
        for (int x = 29; x < 37; ++x) EXPECT_NEAR(alpha(image, x, 32), share, 2e-3 * share) << x;
        EXPECT_NEAR(alpha(image, 48, 32), 1, 1e-6);
    }
}

TEST(ForeignFocus, EvenPicturesOfAnyDepthsStayEven) {
    // Colour and alpha are uniform; depths are random.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius_px(-20, 20);
    for (const float a : {1.0F, 0.5F}) {
        const Bench bench{.width = 60, .height = 40, .margin_px = 0};
        const ForeignPicture p = bench.picture([&](int, int) {
            return Stack{{bench.inverse_z(radius_px(random)), 0.25F * a, 0.5F * a, a, a}};
        });
        for (const FocusMethod method :
             {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
            const FocusResult r = bench.focus(p, method);
            EXPECT_EQ(r.image.alpha.empty(), a == 1) << static_cast<double>(a);
            for (int y = 0; y < 40; ++y) {
                for (int x = 0; x < 60; ++x) {
                    // The mean of equal colours is that colour for any weights. With alphas of 1/2, it is
                    // multiplied by the resulting alpha.
                    const double here = a == 1 ? 1 : static_cast<double>(alpha(r.image, x, y));
                    ASSERT_NEAR(value(r.image, x, y, 0), 0.25 * here, 2e-6);
                    ASSERT_NEAR(value(r.image, x, y, 2), here, 2e-6);
                }
            }
        }
    }
}

TEST(ForeignFocus, WhatNoViewSeesBehindSomethingTranslucentIsNotBlack) {
    // A card with a soft edge, and a veil beside it, in front of a wall that nothing continues beyond the
    // border or behind the card. Some views see the card's edge or the veil there, but not what is behind it.
    // All colours are equal.
    const Bench bench{.width = 40, .height = 24};
    const auto sample = [&](double radius_px, float a) {
        return StackSample{bench.inverse_z(radius_px), 0.25F * a, 0.5F * a, a, a};
    };
    for (const double card_px : {0.0, -7.0}) {
        const ForeignPicture p = bench.picture([&](int x, int) {
            if (x < 16) return Stack{sample(card_px, 1)};
            return Stack{sample(card_px, x == 16 ? 0.3F : 0.1F), sample(3, 0.5F), sample(9, 1)};
        });
        const Image image = bench.focus(p, FocusMethod::lightfield).image;
        EXPECT_TRUE(image.alpha.empty());
        for (int y = 0; y < 24; ++y) {
            for (int x = 0; x < 40; ++x) {
                ASSERT_NEAR(value(image, x, y, 0), 0.25, 2e-6) << x << "," << y;
                ASSERT_NEAR(value(image, x, y, 2), 1, 4e-6) << x << "," << y;
            }
        }
    }
}

TEST(ForeignFocus, AnEvenTransparencyOfOneDepthStaysEven) {
    // A half-transparent sheet in front of nothing, in front of a wall, and behind another sheet. The stored
    // margin is wider than all CoCs, so that nothing is missing at the border.
    const Bench bench{.width = 40, .height = 20, .margin_px = 20};
    for (const double near_px : {-9.0, 0.0, 4.0}) {
        const float near_z = bench.inverse_z(near_px), far_z = bench.inverse_z(15);
        const ForeignPicture alone = bench.picture([&](int, int) {
            return Stack{{near_z, 0.3F, 0.2F, 0.1F, 0.5F}};
        });
        const ForeignPicture wall = bench.picture([&](int, int) {
            return Stack{{near_z, 0.3F, 0.2F, 0.1F, 0.5F}, {far_z, 0, 1, 0, 1}};
        });
        const ForeignPicture two = bench.picture([&](int, int) {
            return Stack{{near_z, 0.3F, 0.2F, 0.1F, 0.5F}, {far_z, 0, 0.5F, 0, 0.75F}};
        });
        for (const FocusMethod method : both) {
            const Image a = bench.focus(alone, method).image, w = bench.focus(wall, method).image,
                        t = bench.focus(two, method).image;
            EXPECT_TRUE(w.alpha.empty());
            for (int x = 0; x < 40; ++x) {
                ASSERT_NEAR(alpha(a, x, 9), 0.5, 2e-6) << near_px;
                ASSERT_NEAR(value(a, x, 9, 0), 0.3, 2e-6);
                ASSERT_NEAR(value(w, x, 9, 1), 0.2 + 0.5, 2e-6);
                ASSERT_NEAR(alpha(t, x, 9), 0.5 + 0.5 * 0.75, 2e-6) << near_px;
                ASSERT_NEAR(value(t, x, 9, 1), 0.2 + 0.5 * 0.5, 2e-6);
            }
        }
    }
}

TEST(ForeignFocus, AnEvenTransparencyOfSeveralDepthsStaysEven) {
    // Three sheets before nothing, with circles that are alike or not, on both sides of the focus.
    const Bench bench{.width = 20, .height = 20, .margin_px = 20};
    for (const double scale : {0.1, 0.3, 1.0, 3.0}) {
        const ForeignPicture p = bench.picture([&](int, int) {
            return Stack{{bench.inverse_z(-3 * scale), 0.4F, 0, 0, 0.5F},
                         {bench.inverse_z(-0.5 * scale), 0, 0.4F, 0, 0.5F},
                         {bench.inverse_z(0.8 * scale), 0, 0, 0.4F, 0.5F}};
        });
        const Image image = bench.focus(p, FocusMethod::layers).image;
        for (int x = 0; x < 20; ++x) {
            ASSERT_NEAR(alpha(image, x, 9), 0.875, 2e-6) << scale;
            ASSERT_NEAR(value(image, x, 9, 0), 0.4, 2e-6) << scale;
            ASSERT_NEAR(value(image, x, 9, 1), 0.2, 2e-6) << scale;
            ASSERT_NEAR(value(image, x, 9, 2), 0.1, 2e-6) << scale;
        }
    }
}

TEST(ForeignFocus, AHoleChangesNothingAtTheBorder) {
    // Light from beyond the border is filled in from around, also in a picture that is transparent elsewhere.
    const Bench bench{.width = 40, .height = 40};
    const ForeignPicture p = bench.picture([&](int x, int y) {
        return x == 20 && y == 20 ? Stack{} : Stack{{bench.inverse_z(6), 0.6F, 0.5F, 0.4F, 1}};
    });
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
        const Image image = bench.focus(p, method).image;
        for (const int at : {0, 3, 39}) {
            EXPECT_NEAR(alpha(image, at, 0), 1, 2e-6) << at;
            EXPECT_NEAR(value(image, at, 20, 0), 0.6, 2e-6) << at;
        }
        EXPECT_LT(alpha(image, 20, 20), 0.999);
    }
}

TEST(ForeignFocus, AVignettedWallIsDarkAndOpaque) {
    const Bench bench{.width = 40, .height = 40};
    ForeignPicture p = bench.picture([&](int x, int y) {
        return x == 20 && y == 20 ? Stack{} : Stack{{0.1F, 0.6F, 0.5F, 0.4F, 1}};
    });
    p.camera.film_distance_mm = 50;
    FocusSettings settings{
        .lens = {.focal_length_mm = 50, .f_number = 1}, .focus_distance_m = 3, .views = 1024};
    settings.impulse.cats_eye = 1;
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
        settings.method = method;
        const Image image = focus_foreign(p, settings).image;
        EXPECT_NEAR(alpha(image, 2, 2), 1, 1e-5);
        EXPECT_LT(value(image, 2, 2, 0), 0.4);
        EXPECT_GT(value(image, 2, 2, 0), 0.2);
    }
}

TEST(ForeignFocus, ViewsSeeThroughSheetsIndependently) {
    // Two half transparent sheets, black and white, before a grey wall: every pixel is 0.5 of black, a
    // quarter of white and a quarter of grey.
    Bench bench{.width = 24, .height = 24, .margin_px = 12};
    bench.settings.views = 1024;
    for (const double apart_px : {4.0, 0.1}) {
        const ForeignPicture p = bench.picture([&](int, int) {
            return Stack{{bench.inverse_z(-apart_px), 0, 0, 0, 0.5F},
                         {bench.inverse_z(0), 0.5F, 0.5F, 0.5F, 0.5F},
                         {bench.inverse_z(apart_px), 0.25F, 0.25F, 0.25F, 1}};
        });
        const Image image = bench.focus(p, FocusMethod::lightfield).image;
        // The pairing of both sheets' thresholds is random: a standard deviation of 0.43 / sqrt(1024) at
        // most.
        double sum = 0;
        for (int y = 0; y < bench.height; ++y) {
            for (int x = 0; x < bench.width; ++x) {
                EXPECT_NEAR(value(image, x, y, 0), 0.3125, 5 * 0.43 / 32);
                sum += static_cast<double>(value(image, x, y, 0));
            }
        }
        EXPECT_NEAR(sum / (bench.width * bench.height), 0.3125, 2e-3);
    }
}

TEST(ForeignFocus, AnEdgeBeforeNothingHasTheAberrationOfTheLens) {
    // The light of a lens point q arrives at (r + s |q|^2) q. The mean over the points is the edge.
    Bench bench{.width = 60, .height = 4, .margin_px = 20};
    bench.settings.views = 1024;
    bench.settings.impulse.spherical = 0.005;
    const double r = 5;
    const ForeignPicture p = bench.picture([&](int x, int) {
        return x < 30 ? Stack{{bench.inverse_z(r), 0.8F, 0.8F, 0.8F, 1}} : Stack{};
    });
    const double s_px = 1000 * bench.settings.impulse.spherical;
    const auto edge = [&](double x) {
        constexpr int steps = 400;
        int all = 0, covered = 0;
        for (int i = 0; i < steps; ++i) {
            for (int k = 0; k < steps; ++k) {
                const double u = 2 * (i + 0.5) / steps - 1, v = 2 * (k + 0.5) / steps - 1, q2 = u * u + v * v;
                if (q2 > 1) continue;
                ++all;
                covered += x + (r + s_px * q2) * u < 30 ? 1 : 0;
            }
        }
        return static_cast<double>(covered) / all;
    };
    for (const FocusMethod method : {FocusMethod::lightfield, FocusMethod::scatter}) {
        const Image image = bench.focus(p, method).image;
        for (int x = 15; x < 45; ++x)
            EXPECT_NEAR(alpha(image, x, 2), edge(x + 0.5), 0.06) << x << ' ' << static_cast<int>(method);
    }
}

TEST(ForeignFocus, VanishingCirclesGiveTheFlattenedPicture) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0, 1);
    std::uniform_int_distribution<int> depth(0, 4);
    const Bench bench{.width = 30, .height = 20, .margin_px = 3};
    const ForeignPicture p = bench.picture([&](int, int) {
        Stack stack;
        for (int k = depth(random); k > 0; --k) {
            const float a = unit(random) < 0.3F ? 1.0F : unit(random);
            stack.push_back(
                {1 - 1e-6F * unit(random), a * unit(random), a * unit(random), a * unit(random), a});
        }
        std::sort(stack.begin(), stack.end(),
                  [](const StackSample& l, const StackSample& r) { return l.inverse_z > r.inverse_z; });
        return stack;
    });
    const Image flat = p.flattened();
    FocusSettings settings{.lens = {.focal_length_mm = 50, .f_number = 4000}, .focus_distance_m = 1};
    settings.method = FocusMethod::pinhole;
    EXPECT_EQ(focus_foreign(p, settings).image.rgb, flat.rgb);
    for (const FocusMethod method : both) {
        settings.method = method;
        const Image image = focus_foreign(p, settings).image;
        for (std::size_t i = 0; i < flat.rgb.size(); ++i) ASSERT_NEAR(image.rgb[i], flat.rgb[i], 2e-5) << i;
        for (std::size_t i = 0; i < flat.alpha.size(); ++i)
            ASSERT_NEAR(image.alpha[i], flat.alpha[i], 2e-5) << i;
    }
}

TEST(ForeignFocus, APointKeepsItsLight) {
    // A bright opaque pixel in a dark wall of the same depth: the sum over the image is conserved.
    const Bench bench{.width = 61, .height = 61, .margin_px = 0};
    for (const double px : {-14.0, -5.0, 8.0}) {
        const ForeignPicture p = bench.picture([&](int x, int y) {
            return Stack{{bench.inverse_z(px), x == 30 && y == 30 ? 100.0F : 0.0F, 0, 0}};
        });
        for (const FocusMethod method : both) {
            const Image image = bench.focus(p, method).image;
            double sum = 0, moment = 0;
            for (int y = 0; y < 61; ++y) {
                for (int x = 0; x < 61; ++x) {
                    sum += static_cast<double>(value(image, x, y, 0));
                    moment += static_cast<double>(value(image, x, y, 0)) * (x - 30);
                }
            }
            EXPECT_NEAR(sum, 100, 1e-3) << px;
            EXPECT_NEAR(moment / sum, 0, 0.01) << px;
        }
    }
}

TEST(ForeignFocus, SameBitsForAnyNumberOfThreads) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    const Bench bench{.width = 90, .height = 70, .margin_px = 0};
    const ForeignPicture p = bench.picture([&](int x, int) {
        return Stack{
            {bench.inverse_z(x / 9 * 5.0 - 22), unit(random), unit(random), 0, x % 5 == 0 ? 0.6F : 1.0F}};
    });
    for (const FocusMethod method : both) {
        const auto with = [&](int threads) {
            const ThreadLimit limit(threads);
            return bench.focus(p, method).image;
        };
        const Image one = with(1), four = with(4);
        EXPECT_EQ(one.rgb, four.rgb);
        EXPECT_EQ(one.alpha, four.alpha);
    }
}

TEST(ForeignFocus, AHalfPlaneThatEndsInsideAPixelIsItsOwnEdge) {
    // The pixel at the edge has the depth of the background, or a mean depth of no surface. Unmixed, it
    // consists of the half-plane with one share and of the background with the rest.
    const Bench bench{.width = 80, .height = 24, .margin_px = 40};
    constexpr int x0 = 40;
    constexpr float share = 0.7F;
    for (const double near_px : {-3.3, -12.0}) {
        for (const double far_px : {0.0, 3.0}) {
            for (const double edge_px : {far_px, 0.7 * near_px + 0.3 * far_px}) {
                ForeignPicture p = bench.picture([&](int x, int) {
                    const StackSample near{bench.inverse_z(near_px), 1, 0.5F, 0, 1, 1},
                        far{bench.inverse_z(far_px), 0, 0.25F, 1, 1, 2};
                    if (x != x0) return Stack{x > x0 ? near : far};
                    return Stack{{bench.inverse_z(edge_px), share, share * 0.5F + (1 - share) * 0.25F,
                                  1 - share, 1, 1}};
                });
                const FocusResult mixed = bench.focus(p, FocusMethod::layers);
                for (int y = p.y_begin; y < p.y_end; ++y) {
                    const auto pixel =
                        static_cast<std::size_t>((y - p.y_begin) * (p.x_end - p.x_begin) + (x0 - p.x_begin));
                    p.mixed.push_back({pixel, p.shares.size(), 2});
                    p.shares.push_back({1, share});
                    p.shares.push_back({2, 1 - share});
                }
                EXPECT_EQ(unmix_edges(p), static_cast<std::size_t>(p.y_end - p.y_begin));
                const FocusResult apart = bench.focus(p, FocusMethod::layers);
                EXPECT_TRUE(apart.image.alpha.empty());
                double largest = 0;
                for (int x = 0; x < 80; ++x) {
                    const double r = level_radius(near_px), t = x + 0.5 - x0;
                    const double front = static_cast<double>(share) * edge_response(t / r) +
                                         (1 - static_cast<double>(share)) * edge_response((t - 1) / r);
                    ASSERT_NEAR(value(apart.image, x, 12, 0), front, 3e-6)
                        << near_px << " " << far_px << " " << edge_px << " " << x;
                    ASSERT_NEAR(value(apart.image, x, 12, 2), 1 - front, 3e-6) << x;
                    largest = std::max(largest,
                                       std::abs(static_cast<double>(value(mixed.image, x, 12, 0)) - front));
                }
                EXPECT_GT(largest, 0.01) << near_px << " " << far_px << " " << edge_px;
            }
        }
    }
}

TEST(ForeignFocus, ALampBesideAnEdgeIsNotAllThatIsBehindIt) {
    // A bar in front of a wall, and beside it a light source at the depth of the wall.
    const Bench bench{.width = 40, .height = 9};
    for (const bool with_ids : {true, false}) {
        const ForeignPicture p = bench.picture([&](int x, int y) {
            const auto id = [&](std::uint32_t i) { return with_ids ? i : 0; };
            if (x >= 18 && x < 22) return Stack{{bench.inverse_z(-20), 0, 0, 0, 1, id(1)}};
            if (x == 22 && y == 4) return Stack{{bench.inverse_z(2), 50, 50, 50, 1, id(3)}};
            return Stack{{bench.inverse_z(2), 0.25F, 0.5F, 1, 1, id(2)}};
        });
        const FocusGeometry geometry =
            focus_geometry({.focal_length_mm = 2000, .f_number = 1}, 1, Framing::keep,
                           {p.camera.film_distance_mm, p.pixel_pitch_mm()});
        const std::vector<Behind> behind = behind_fill(p, geometry);
        const Behind& next = behind[4 * 40 + 20];
        ASSERT_TRUE(next.known);
        if (with_ids) {
            EXPECT_NEAR(next.r, 0.25, 1e-6);
            EXPECT_NEAR(next.b, 1, 1e-6);
            EXPECT_EQ(next.inverse_z, bench.inverse_z(2));
        } else {
            EXPECT_GT(next.r, 1);
        }
    }
}

TEST(ForeignFocus, APartOfALightFieldHasTheBitsOfTheWholeWhereGapsAreFilled) {
    // One view from the side of the lens: along a border of the image it sees nothing that is stored.
    Bench bench{.width = 40, .height = 24};
    bench.settings.views = 1;
    const ForeignPicture p = bench.picture([&](int x, int y) {
        const float v = 0.2F + 0.01F * static_cast<float>(x + y);
        return Stack{{bench.inverse_z(x < 20 ? -14 : 14), v, 1 - v, 0.5F, 1, x < 20 ? 1U : 2U}};
    });
    const FocusResult whole = bench.focus(p, FocusMethod::lightfield);
    for (int y = 0; y < 24; y += 6) {
        bench.settings.crop = Crop{0, y, 40, 6};
        const FocusResult part = bench.focus(p, FocusMethod::lightfield);
        for (int row = y; row < y + 6; ++row) {
            for (int x = 0; x < 40; ++x) {
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_EQ(value(part.image, x, row, c), value(whole.image, x, row, c)) << x << "," << row;
            }
        }
    }
}

TEST(ForeignFocus, PixelsThatAreNotSquareShowADiscAsAnEllipse) {
    // Pixels twice as wide as tall: the disc of 12 px of radius across rows has 6 px across columns. The
    // outline of the ellipse is a polygon.
    const Bench bench{.width = 60, .height = 60, .margin_px = 20};
    for (const bool upright : {true, false}) {
        ForeignPicture p = bench.picture([&](int x, int y) {
            return (upright ? x : y) < 30 ? Stack{} : Stack{{bench.inverse_z(-6), 1, 1, 1}};
        });
        p.pixel_aspect = 2;
        const double radius_px = level_radius(-12) / (upright ? 2 : 1);
        for (const FocusMethod method :
             {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield}) {
            const FocusResult r = bench.focus(p, method);
            EXPECT_NEAR(r.largest_coc_px, 24, 0.1);
            const double error = method == FocusMethod::lightfield ? 0.04 : 0.002;
            for (int i = 0; i < 60; ++i) {
                ASSERT_NEAR(alpha(r.image, upright ? i : 30, upright ? 30 : i),
                            edge_response((i + 0.5 - 30) / radius_px), error)
                    << upright << " " << i;
            }
        }
    }
    EXPECT_THROW((void)impulse_in_px({.kind = ImpulseKind::diffraction}, 2), Error);
}

TEST(ForeignFocus, OtherMethodsAreRefused) {
    const Bench bench;
    const ForeignPicture p = bench.picture([](int, int) { return Stack{}; });
    expect_refused([&] { (void)bench.focus(p, FocusMethod::hybrid); }, ExitCode::wrong_arguments);
}

TEST(ForeignFocus, AZoomedFrameKeepsColourAndAlpha) {
    // A film at F = 2 d magnifies the middle of the image by 2.
    Bench bench{.width = 40, .height = 40, .margin_px = 0};
    const ForeignPicture p = bench.picture([](int x, int) {
        return x < 20 ? Stack{{0, 0.5F, 0.5F, 0.5F, 0.5F}} : Stack{{0, 1, 1, 1, 1}};
    });
    FocusSettings settings{.lens = {.focal_length_mm = 2 * p.camera.film_distance_mm,
                                    .f_number = std::numeric_limits<double>::infinity()},
                           .focus_distance_m = std::numeric_limits<double>::infinity(),
                           .framing = Framing::lens,
                           .method = FocusMethod::pinhole};
    const Image image = focus_foreign(p, settings).image;
    EXPECT_EQ(image.width, 40);
    EXPECT_NEAR(alpha(image, 5, 20), 0.5, 1e-6);
    EXPECT_NEAR(alpha(image, 35, 20), 1, 1e-6);
    EXPECT_NEAR(value(image, 35, 20, 1), 1, 1e-6);
}

}  // namespace
}  // namespace postlens::test::foreign_focus_test
