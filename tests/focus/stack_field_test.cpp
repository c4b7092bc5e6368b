// The light field of images of other programs: against a slow reference, closed forms, conservation.
#include "focus/foreign/stack_field.h"

#include <gtest/gtest.h>
#include <random>

#include "core/sample_hash.h"
#include "core/sobol.h"
#include "core/threads.h"
#include "tests/support/edge_response.h"
#include "tests/support/stack_bench.h"

namespace postlens::test::stack_field_test {
namespace {

using Bench = StackBench;

FocusGeometry geometry_of(const Bench& bench) {
    return {.aperture_radius_m = 1, .inverse_focus_per_m = bench.inverse_focus_per_m, .gain_px = 1000};
}

StackField field_of(const Bench& bench, const ForeignPicture& p, int views) {
    const RasterWindow window{0, bench.width, 0, bench.height};
    return stack_field(p, {}, {geometry_of(bench), Aperture(Impulse{}), window, window, views});
}

/// Threshold of a sample in a view: a scrambled radical inverse of the view's place in an order of the
/// sample.
std::uint32_t threshold_of(std::uint32_t seed, std::uint32_t view) {
    const auto scrambled = [](std::uint32_t digits_reversed, std::uint32_t by) {
        return reverse_bits(owen_scramble_reversed(digits_reversed, by));
    };
    return scrambled(scrambled(reverse_bits(view), seed), mix32(seed));
}

/// The same picture, one view and one pixel after the other, from all samples. Only for samples none of which
/// continues its neighbour's surface, so that each is the square of its pixel.
Image squares_one_by_one(const Bench& bench, const ForeignPicture& p, int views) {
    Image out(bench.width, bench.height);
    out.alpha.resize(out.rgb.size() / 3);
    std::vector<std::array<double, 4>> sums(out.alpha.size());
    const auto points = lens_view_points(Aperture(Impulse{}), geometry_of(bench), views);
    for (int v = 0; v < views; ++v) {
        const LensViewPoint& view = points[static_cast<std::size_t>(v)];
        for (int y = 0; y < bench.height; ++y) {
            for (int x = 0; x < bench.width; ++x) {
                const glm::dvec2 at = glm::dvec2(x, y) + view.place;
                std::vector<std::pair<const StackSample*, bool>> here;  // and whether it is opaque
                for (int j = p.y_begin; j < p.y_end; ++j) {
                    for (int i = p.x_begin; i < p.x_end; ++i) {
                        std::uint32_t k = 0;
                        for (const StackSample& s : p.stack(i, j)) {
                            const glm::dvec2 corner =
                                glm::dvec2(i, j) + view.shift.lens_px * (view.shift.inverse_focus_per_m -
                                                                         static_cast<double>(s.inverse_z));
                            const auto pixel = static_cast<std::uint64_t>(j - p.y_begin) *
                                                   static_cast<std::uint64_t>(p.x_end - p.x_begin) +
                                               static_cast<std::uint64_t>(i - p.x_begin);
                            const std::uint32_t threshold =
                                threshold_of(random_word(pixel, k++), static_cast<std::uint32_t>(v));
                            if (at.x >= corner.x && at.x < corner.x + 1 && at.y >= corner.y &&
                                at.y < corner.y + 1)
                                here.emplace_back(&s, threshold * 0x1p-32 < static_cast<double>(s.alpha));
                        }
                    }
                }
                std::stable_sort(here.begin(), here.end(), [](const auto& a, const auto& b) {
                    return a.first->inverse_z > b.first->inverse_z;
                });
                auto& sum = sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(bench.width) +
                                 static_cast<std::size_t>(x)];
                for (const auto& [s, opaque] : here) {
                    sum[0] += static_cast<double>(s->r);
                    sum[1] += static_cast<double>(s->g);
                    sum[2] += static_cast<double>(s->b);
                    sum[3] += static_cast<double>(s->alpha);
                    if (opaque) break;
                }
            }
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * k + c] = static_cast<float>(sums[k][c] / views);
        out.alpha[k] = static_cast<float>(sums[k][3] / views);
    }
    return out;
}

TEST(StackField, IsWhatTheSlowReferenceDraws) {
    // Depths that jump by more than a pixel of radius from sample to sample.
    // Circles of confusion of up to 13 px, so that what continues beyond the stored pixels reaches no view.
    const Bench bench{.width = 20, .height = 28, .margin_px = 15};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    const ForeignPicture p = bench.picture([&](int x, int y) {
        Stack out;
        const double base = -9 + 2.0 * ((x + 15 + 3 * (y + 15)) % 3);
        const int count = static_cast<int>(3 * unit(random));
        for (int k = 0; k <= count; ++k) {
            const float a = k == count ? 1 : unit(random);
            out.push_back(
                {bench.inverse_z(base + 8 * k), a * unit(random), a * unit(random), a * unit(random), a});
        }
        return out;
    });
    constexpr int views = 24;
    const Image fast = field_of(bench, p, views).image, slow = squares_one_by_one(bench, p, views);
    // Single precision moves a square by up to 4e-6 px, so that a point of 24 x 560 may change its square.
    int other = 0;
    for (std::size_t i = 0; i < fast.rgb.size(); ++i)
        other += std::abs(fast.rgb[i] - slow.rgb[i]) > 1e-5F ? 1 : 0;
    EXPECT_LE(other, 3 * 2);
    for (std::size_t i = 0; i < fast.alpha.size(); ++i) EXPECT_NEAR(fast.alpha[i], slow.alpha[i], 0.1F) << i;
}

TEST(StackField, AHalfPlaneIsItsOwnEdge) {
    // The mean of N views has the error of a quadrature with N points; Owen-scrambled ones stay well below
    // random ones, whose standard deviation is 1/2 / sqrt(N).
    const Bench bench{.width = 60, .height = 4, .margin_px = 30};
    constexpr int views = 4096, x0 = 30;
    for (const double near_px : {-3.3, -12.0}) {
        for (const double far_px : {0.0, 11.0}) {
            const ForeignPicture p = bench.picture([&](int x, int) {
                const StackSample far{bench.inverse_z(far_px), 0, 0.25F, 1};
                if (x < x0) return Stack{far};
                return Stack{{bench.inverse_z(near_px), 1, 0.5F, 0}, far};
            });
            const StackField f = field_of(bench, p, views);
            for (int x = 0; x < bench.width; ++x) {
                // Box filter of a pixel over the disc's edge, by Simpson's rule.
                double front = 0;
                constexpr int steps = 16;
                for (int k = 0; k <= steps; ++k) {
                    const double w = k == 0 || k == steps ? 1 : k % 2 == 1 ? 4 : 2;
                    front +=
                        w / (3 * steps) * edge_response((x + k / double{steps} - x0) / std::abs(near_px));
                }
                ASSERT_NEAR(value(f.image, x, 1, 0), front, 0.5 / 64) << near_px << " " << far_px << " " << x;
                ASSERT_NEAR(value(f.image, x, 1, 2), 1 - front, 0.5 / 64) << near_px << " " << x;
                ASSERT_NEAR(alpha(f.image, x, 1), 1, 1e-6);
            }
        }
    }
}

TEST(StackField, SlopesHaveNoCracks) {
    // A floor whose radius changes by 0.7 px from row to row, an even colour.
    const Bench bench{.width = 24, .height = 48, .margin_px = 24};
    const ForeignPicture p = bench.picture([&](int, int y) {
        return Stack{{bench.inverse_z(0.7 * (y - 24)), 0.25F, 0.5F, 0.75F}};
    });
    const StackField f = field_of(bench, p, 64);
    // From the rim of the lens the rows stored, -24 to 72, fall on 9.6 to 38.4.
    for (int y = 10; y < 38; ++y) {
        for (int x = 0; x < bench.width; ++x) {
            ASSERT_EQ(f.unseen[static_cast<std::size_t>(y * bench.width + x)], 0) << x << "," << y;
            ASSERT_NEAR(value(f.image, x, y, 1), 0.5, 1e-6) << x << "," << y;
        }
    }
}

TEST(StackField, InFocusIsThePictureItself) {
    const Bench bench{.width = 20, .height = 12};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    const ForeignPicture p = bench.picture([&](int, int) {
        return Stack{{bench.inverse_z(0), unit(random), unit(random), unit(random)}};
    });
    const StackField f = field_of(bench, p, 8);
    const Image flat = p.flattened();
    for (std::size_t i = 0; i < flat.rgb.size(); ++i) EXPECT_NEAR(f.image.rgb[i], flat.rgb[i], 1e-6F) << i;
}

TEST(StackField, AVeilCoversItsShare) {
    const Bench bench{.width = 16, .height = 8, .margin_px = 16};
    const ForeignPicture p = bench.picture([&](int, int) {
        return Stack{{bench.inverse_z(-6), 0.3F, 0, 0, 0.3F}, {bench.inverse_z(4), 0, 0, 1, 0.5F}};
    });
    const StackField f = field_of(bench, p, 1024);
    // Thresholds are spread evenly over the views of a sample, and each pixel sees many samples.
    for (int x = 0; x < bench.width; ++x) {
        EXPECT_NEAR(value(f.image, x, 4, 0), 0.3, 1e-5);
        EXPECT_NEAR(value(f.image, x, 4, 2), 0.7, 0.05);
        EXPECT_NEAR(alpha(f.image, x, 4), 0.3 + 0.7 * 0.5, 0.03);
    }
}

TEST(StackField, SameBitsForAnyNumberOfThreadsAndAnyPart) {
    const Bench bench{.width = 40, .height = 70, .margin_px = 8};
    const ForeignPicture p = bench.picture([&](int x, int y) {
        const float v = 0.5F + 0.01F * static_cast<float>((x * 7 + y * 13) % 40);
        return Stack{{bench.inverse_z(((x / 5) % 3) * 4 - 6), 0.7F * v, v, 0, 0.7F},
                     {bench.inverse_z(5), v, 0, v}};
    });
    const StackField whole = field_of(bench, p, 32);
    {
        const ThreadLimit one(1);
        EXPECT_EQ(field_of(bench, p, 32).image.rgb, whole.image.rgb);
    }
    const RasterWindow window{0, bench.width, 0, bench.height}, part{11, 29, 17, 54};
    const StackField cut = stack_field(p, {}, {geometry_of(bench), Aperture(Impulse{}), window, part, 32});
    for (int y = part.y_begin; y < part.y_end; ++y) {
        for (int x = part.x_begin; x < part.x_end; ++x) {
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_EQ(value(cut.image, x, y, c), value(whole.image, x, y, c)) << x << "," << y;
        }
    }
    EXPECT_EQ(value(cut.image, 2, 2, 1), 0);
}

}  // namespace
}  // namespace postlens::test::stack_field_test
