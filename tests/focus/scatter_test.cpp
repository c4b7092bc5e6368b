// The scatter method on records in memory: kernels, depth levels, closed forms, fast against slow versions.
#include "focus/scatter/scatter.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "core/error.h"
#include "core/threads.h"
#include "lens/ellipse_coverage.h"
#include "records/quadtree.h"
#include "tests/focus/focus_records.h"
#include "tests/support/random_records.h"

namespace postlens {
namespace {

using namespace test;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr KernelReach far{100000, 100000};

// --- kernels
// ---------------------------------------------------------------------------------------------------

TEST(Kernel, HoldsTheCoverage) {
    for (const Ellipse& e : {Ellipse::disc(1e-4), Ellipse::disc(0.7), Ellipse::disc(5.5), Ellipse::disc(40),
                             Ellipse{9, 4, 0.7}, Ellipse{0.3, 20, 0}, Ellipse{30, 6, -2}}) {
        for (const double phase : {0.0, 0.3125, -0.25, 0.9375}) {
            const Kernel kernel = make_kernel(e, phase, 0.5 - phase, far);
            const auto rows = ellipse_coverage(e, phase, 0.5 - phase);
            ASSERT_EQ(kernel.rows.size(), rows.size());
            for (std::size_t j = 0; j < rows.size(); ++j) {
                const KernelRow& row = kernel.rows[j];
                ASSERT_EQ(kernel.y_begin + static_cast<int>(j), rows[j].y);
                ASSERT_EQ(row.x_begin, rows[j].x_begin);
                ASSERT_EQ(static_cast<std::size_t>(row.x_end - row.x_begin), rows[j].share.size());
                double sum = 0;
                for (int x = row.x_begin; x < row.x_end; ++x) {
                    const bool inner = x >= row.inner_begin && x < row.inner_end;
                    const int skipped =
                        x < row.inner_begin ? row.x_begin : row.x_begin + row.inner_end - row.inner_begin;
                    const double got = static_cast<double>(
                        inner ? kernel.inner
                              : kernel.taps[row.tap + static_cast<std::uint32_t>(x - skipped)]);
                    const double wanted = rows[j].share[static_cast<std::size_t>(x - row.x_begin)];
                    EXPECT_NEAR(got, wanted, 1e-7 * wanted);
                    sum += got;
                }
                EXPECT_NEAR(static_cast<double>(row.sum), sum, 1e-6 * sum);
            }
        }
    }
}

TEST(Kernel, LeavesOutWhatIsOutOfReach) {
    const Kernel whole = make_kernel(Ellipse::disc(50), 0, 0, far);
    const Kernel cut = make_kernel(Ellipse::disc(50), 0, 0, {30, 20});
    EXPECT_EQ(cut.y_begin, -20);
    EXPECT_EQ(cut.y_end(), 20);
    EXPECT_EQ(cut.x_begin, -30);
    EXPECT_EQ(cut.x_end, 30);
    EXPECT_EQ(cut.inner, whole.inner);
    const Kernel huge = make_kernel(Ellipse::disc(1e5), 0, 0, {30, 20});
    EXPECT_EQ(huge.rows.size(), 40U);
    EXPECT_TRUE(huge.taps.empty());
}

TEST(KernelKey, EllipsesAreRightToAnEighthOfAPixel) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> size(0.3, 60), shear(-3, 3);
    const ResponseModel round;
    const KernelTable table({1.0}, far, round);
    for (int i = 0; i < 500; ++i) {
        const Ellipse e{size(random), size(random), shear(random)};
        const Ellipse kept = table.outline(KernelKey::ellipse(e));
        EXPECT_LE(std::abs(kept.half_height - e.half_height), 0.125);
        EXPECT_LE(std::abs(kept.half_chord - e.half_chord), 0.125);
        EXPECT_LE(std::abs(kept.shear * kept.half_height - e.shear * e.half_height), 0.125 + 1e-9);
    }
    for (double radius_px = 0.3; radius_px < KernelKey::fine_below_px; radius_px += 0.01) {
        const Ellipse kept = table.outline(KernelKey::ellipse(Ellipse::disc(radius_px), true));
        EXPECT_LE(std::abs(kept.half_height - radius_px), KernelKey::fine_step_px / 2 + 1e-12);
        EXPECT_EQ(kept.half_height, kept.half_chord);
    }
    EXPECT_FALSE(KernelKey::ellipse(Ellipse::disc(KernelKey::fine_below_px), true).is_fine);
    const Ellipse vast = table.outline(KernelKey::ellipse({1e9, 3e9, 0.5}));
    EXPECT_LE(vast.half_width(), KernelKey::largest_ellipse_px + 1);
    EXPECT_LE(table.outline(KernelKey::ellipse(Ellipse::disc(1e-3))).half_width(), 1e-3);
}

TEST(KernelTable, PacksKeysWithoutCollision) {
    std::map<KernelKey::Packed, KernelKey> seen;
    for (const std::int32_t size : {0, 1, 2, 64000}) {
        for (const std::int32_t displacement : {-64000, -1, 0, 1, 64000}) {
            for (const std::int32_t phase : {-16, 0, 16}) {
                const KernelKey key{.is_disc = false,
                                    .half_height = size,
                                    .half_chord = 64000 - size,
                                    .top_displacement = displacement,
                                    .phase_x = phase,
                                    .phase_y = -phase};
                EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
            }
        }
    }
    for (const std::uint32_t level : {0U, 1U, 4000U}) {
        for (const std::int32_t phase : {-16, 0, 16}) {
            const KernelKey key{.level = level, .phase_x = phase};
            EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
            KernelKey other = key;
            other.upside_down = true;
            EXPECT_TRUE(seen.try_emplace(other.packed(), other).second);
            for (const std::int32_t cell : {-300, -1, 0, 1, 300}) {
                for (const std::int32_t width : {3, 10}) {
                    other.cell_x = cell;
                    other.cell_y = 2 - cell;
                    other.cell_log2 = width;
                    EXPECT_TRUE(seen.try_emplace(other.packed(), other).second);
                }
            }
        }
    }
    // In fine steps the same numbers stand for smaller values.
    for (const std::int32_t size : {0, 1, 2}) {
        const KernelKey key{.is_disc = false,
                            .is_fine = true,
                            .half_height = size,
                            .half_chord = 64000 - size,
                            .top_displacement = 1,
                            .phase_x = 16,
                            .phase_y = -16};
        EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
    }
    // Maps that are far apart differ in their leading bits.
    for (const double yy : {-100.0, -0.25, 0.0, 0.25, 100.0}) {
        for (const double xy : {-7.0, 0.0, 7.0}) {
            const KernelKey key = KernelKey::map({5, xy, -xy, yy});
            EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
        }
    }
    for (const double yy : {-16000.0, 16000.0}) {
        const KernelKey key = KernelKey::map({5, 0, 0, yy});
        EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
    }
}

TEST(KernelTable, CoarsenedKeysOfOppositeShearDoNotCollide) {
    for (int times = 0; times <= KernelKey::most_coarsenings; ++times) {
        KernelKey left = KernelKey::ellipse({1, 1, -20000}), right = KernelKey::ellipse({1, 1, 20000});
        left.coarsen(times);
        right.coarsen(times);
        EXPECT_LT(left.top_displacement, 0);
        EXPECT_GT(right.top_displacement, 0);
        EXPECT_NE(left.packed(), right.packed()) << times;
    }
}

TEST(KernelTable, MapsKeepTheirLeadingBits) {
    const ResponseModel round;
    const KernelTable table({1.0}, far, round);
    const glm::dmat2 small{3.25, -0.5, 0.75, 1}, large{1000, -3, 500, 7};
    EXPECT_EQ(table.map_px(KernelKey::map(small)), small);
    // 4000 quarters of a pixel have 12 bits, of which 6 are kept, which makes steps of 16 px.
    EXPECT_EQ(table.map_px(KernelKey::map(large)), glm::dmat2(1008, 0, 496, 0));
    KernelKey key = KernelKey::map(small);
    key.cell_x = -3;
    key.cell_y = 5;
    key.cell_log2 = 4;
    key.coarsen(1);
    EXPECT_EQ(table.map_px(key), glm::dmat2(3.25, -0.5, 0.75, 1));
    EXPECT_EQ(std::tuple(key.cell_x, key.cell_y, key.cell_log2), std::tuple(-2, 2, 5));
}

TEST(KernelTable, CoarsensEllipsesToFitItsMemory) {
    const auto bytes_with = [](std::size_t limit) {
        const ResponseModel round;
        KernelTable table({1.0}, far, round);
        std::vector<std::uint32_t> numbers;
        for (int i = 0; i < 200; ++i)
            numbers.push_back(table.number_of(KernelKey::ellipse({10 + 0.25 * i, 20, 0.1})));
        table.build(limit);
        std::size_t bytes = 0;
        std::unordered_map<const Kernel*, bool> seen;
        for (const std::uint32_t n : numbers) {
            double sum = 0;
            for (const KernelRow& row : table[n].rows) sum += static_cast<double>(row.sum);
            EXPECT_NEAR(sum, 1, 1e-5);
            if (!seen.try_emplace(&table[n], true).second) continue;
            bytes += table[n].rows.size() * sizeof(KernelRow) + table[n].taps.size() * sizeof(float);
        }
        return bytes;
    };
    const std::size_t all = bytes_with(std::size_t{1} << 30);
    EXPECT_LT(bytes_with(all / 4), all / 4);
}

/// Kernel tables from which many small and large ellipses are requested, far more than fit.
struct ManySizes {
    explicit ManySizes(bool backwards) {
        for (int i = 0; i < 400; ++i) asked.push_back({200 + 2.0 * i, 150 + i / 4.0, 0.1});
        for (int i = 0; i < 200; ++i) asked.push_back({4 + i / 20.0, 3 + i / 40.0, 0.2});
        if (backwards) std::reverse(asked.begin(), asked.end());
        for (const Ellipse& e : asked) numbers.push_back(table.number_of(KernelKey::ellipse(e)));
        table.build(1 << 20);
        if (!backwards) return;
        std::reverse(asked.begin(), asked.end());
        std::reverse(numbers.begin(), numbers.end());
    }
    [[nodiscard]] const Kernel& kernel(std::size_t i) const { return table[numbers[i]]; }

    ResponseModel round;
    KernelTable table{{1.0}, far, round};
    std::vector<Ellipse> asked;
    std::vector<std::uint32_t> numbers;
};

TEST(KernelTable, CoarsenedEllipsesKeepTheirSizeWhateverOthersThereAre) {
    const ManySizes many(false);
    std::size_t bytes = 0;
    std::unordered_map<const Kernel*, bool> seen;
    for (std::size_t i = 0; i < many.asked.size(); ++i) {
        const Kernel& kernel = many.kernel(i);
        if (seen.try_emplace(&kernel, true).second)
            bytes += kernel.rows.size() * sizeof(KernelRow) + kernel.taps.size() * sizeof(float);
        // A kernel touches up to one more row on each side. Large kernels are coarsened first.
        const double half_height = many.asked[i].half_height;
        EXPECT_NEAR(static_cast<double>(kernel.rows.size()) / 2, half_height,
                    half_height * (half_height < 20 ? 1.0 / 16 : 1.0 / 4) + 1)
            << half_height;
    }
    EXPECT_LT(bytes, std::size_t{1} << 20);
    EXPECT_LT(seen.size(), many.asked.size());
}

// Threads request kernels in any order, which must not change the result.
TEST(KernelTable, CoarsensTheSameInWhateverOrderShapesComeIn) {
    const ManySizes forwards(false), backwards(true);
    for (std::size_t i = 0; i < forwards.asked.size(); ++i) {
        const Kernel &a = forwards.kernel(i), &b = backwards.kernel(i);
        EXPECT_EQ(a.rows.size(), b.rows.size());
        EXPECT_EQ(a.taps, b.taps) << i;
    }
}

// --- depth levels
// ------------------------------------------------------------------------------------------------

constexpr FocusGeometry lens_geometry{
    .aperture_radius_m = 0.0179, .inverse_focus_per_m = 0.2, .gain_px = 1333, .zoom = 1};

double diameter_error(const DepthLevels& levels, double inverse_depth) {
    const auto level = levels.level_of(inverse_depth);
    if (!level) return infinity;
    return std::abs(2 * levels.radius_px()[*level] - std::abs(lens_geometry.coc_diameter_px(inverse_depth)));
}

TEST(DepthLevels, OwnChoiceQuantisesTheCocByLessThanAQuarterOfAPixel) {
    const DepthLevels levels(lens_geometry, {0.3, 100.0}, DepthSpacing::inverse, std::nullopt);
    for (double inverse = 0; inverse < 30; inverse += 1e-3) {
        const bool sharp = std::abs(lens_geometry.coc_diameter_px(inverse)) < 0.4;
        EXPECT_LT(diameter_error(levels, inverse), sharp ? 0.4 : 0.25) << inverse;
    }
    // Inverse depths can be negative after reflection or refraction.
    for (double inverse = -20; inverse < 0; inverse += 1e-3)
        EXPECT_LT(diameter_error(levels, inverse), 0.25) << inverse;
    // Small CoCs have an error of at most 1 % or 1/16 px.
    for (double inverse = 0; inverse < 1.2; inverse += 1e-4) {
        const double diameter_px = std::abs(lens_geometry.coc_diameter_px(inverse));
        if (diameter_px < 0.4) {
            EXPECT_EQ(levels.level_of(inverse), 0U) << inverse;
        } else if (diameter_px < 24.5) {
            EXPECT_LE(diameter_error(levels, inverse), std::max(0.0626, 0.0101 * diameter_px)) << inverse;
        }
    }
    // Very large CoCs have an error of at most 1/500.
    for (double inverse = 50; inverse < 4000; inverse *= 1.01) {
        EXPECT_LT(diameter_error(levels, inverse), 2e-3 * lens_geometry.coc_diameter_px(-inverse)) << inverse;
    }
    EXPECT_EQ(levels.radius_px()[*levels.level_of(1e30)], DepthLevels::largest_radius_px);
    EXPECT_EQ(levels.radius_px()[*levels.level_of(0.2)], DepthLevels::smallest_radius_px);
    EXPECT_FALSE(levels.depths().has_value());
}

TEST(DepthLevels, GivenNumberIsLaidFromNearestToFarthest) {
    const DepthRange range{0.5, 8.5};
    const DepthLevels linear(lens_geometry, range, DepthSpacing::linear, 5);
    const DepthLevels inverse(lens_geometry, range, DepthSpacing::inverse, 5);
    ASSERT_EQ(linear.radius_px().size(), 6U);
    for (int i = 0; i < 5; ++i) {
        const auto level = static_cast<std::size_t>(i);
        EXPECT_NEAR(linear.radius_px()[level],
                    std::abs(lens_geometry.coc_diameter_px(1 / (0.5 + 2.0 * i))) / 2, 1e-9);
        EXPECT_NEAR(inverse.radius_px()[level],
                    std::abs(lens_geometry.coc_diameter_px(2 + (1 / 8.5 - 2) * i / 4)) / 2, 1e-9);
    }
    EXPECT_EQ(linear.level_of(1 / 3.4), 1U);
    EXPECT_EQ(linear.level_of(1 / 3.6), 2U);
    EXPECT_EQ(linear.level_of(0), 5U);
    EXPECT_EQ(inverse.level_of(0), 5U);
    EXPECT_EQ(inverse.level_of(2), 0U);
    EXPECT_EQ(inverse.level_of(1 / 8.5), 4U);
    EXPECT_NEAR(linear.radius_px()[5], lens_geometry.coc_diameter_px(0) / 2, 1e-12);
    EXPECT_FALSE(linear.level_of(-1).has_value());
    EXPECT_FALSE(inverse.level_of(9).has_value());
    EXPECT_EQ(linear.depths(), 5);
}

TEST(DepthLevels, LinearSpacingTakesAsManyAsItNeeds) {
    const DepthLevels levels(lens_geometry, {2.0, 6.0}, DepthSpacing::linear, std::nullopt);
    ASSERT_TRUE(levels.depths().has_value());
    EXPECT_LT(*levels.depths(), DepthLevels::most_linear_levels);
    for (double z_m = 2; z_m <= 6; z_m += 1e-3) EXPECT_LT(diameter_error(levels, 1 / z_m), 0.5) << z_m;
    const DepthLevels capped(lens_geometry, {0.1, 1000.0}, DepthSpacing::linear, std::nullopt);
    EXPECT_EQ(*capped.depths(), DepthLevels::most_linear_levels);
}

TEST(DepthLevels, OneDepthOrNoneIsEnough) {
    for (const DepthSpacing spacing : {DepthSpacing::linear, DepthSpacing::inverse}) {
        const DepthLevels one(lens_geometry, {3.0, 3.0}, spacing, 8);
        EXPECT_EQ(one.level_of(1 / 3.0), 0U);
        EXPECT_NEAR(one.radius_px()[0], std::abs(lens_geometry.coc_diameter_px(1 / 3.0)) / 2, 1e-12);
        EXPECT_FALSE(one.level_of(1).has_value());
        const DepthLevels none(lens_geometry, {}, spacing, 8);
        EXPECT_EQ(none.level_of(0), 0U);
        EXPECT_FALSE(none.level_of(1).has_value());
    }
}

TEST(DepthLevels, RefusesNumbersOutOfRange) {
    for (const int k : {-1, 0, 1, DepthLevels::most_depths + 1}) {
        try {
            const DepthLevels levels(lens_geometry, {1.0, 2.0}, DepthSpacing::inverse, k);
            FAIL() << k;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
            EXPECT_NE(
                std::string(e.what()).find("number of depths is out of range (got " + std::to_string(k)),
                std::string::npos);
        }
    }
}

// --- closed forms
// ------------------------------------------------------------------------------------------------

/// A step edge blurred by a disc of radius 1, at distance t from the edge.
double edge_response(double t) {
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
}

TEST(Scatter, EdgeIsTheClosedForm) {
    // Discs at integer coordinates from x0 on add up to the edge response at the right side of each pixel,
    // because the columns of a disc are integrals of its profile.
    for (const double radius : {0.8, 3.3, 7.5, 21.0, 40.5}) {
        constexpr int x0 = 60;
        TableOptions options{.depths = 2};
        const auto across =
            scattered(corner_band(120, 20, 60,
                                  [&](int x, int) {
                                      const float v = x >= x0 ? 1.0F : 0.0F;
                                      return std::vector{corner(1 / radius, v, 0.5F * v, 1 - v)};
                                  }),
                      60, options);
        const auto down = scattered(
            corner_band(
                20, 120, 60,
                [&](int, int y) { return std::vector{corner(1 / radius, y >= x0 ? 1.0F : 0.0F, 0, 0)}; }),
            60, options);
        for (int i = 0; i < 120; ++i) {
            // z' is a float, so the radius has float rounding.
            const double wanted = edge_response((i + 1 - x0) / radius);
            EXPECT_NEAR(value(across, i, 10, 0), wanted, 1e-6) << radius << " " << i;
            EXPECT_NEAR(value(across, i, 10, 1), wanted / 2, 1e-6);
            EXPECT_NEAR(value(across, i, 10, 2), 1 - wanted, 1e-6);
            EXPECT_NEAR(value(down, 10, i, 0), wanted, 1e-6);
        }
    }
}

struct Point {
    double energy = 0, x = 0, y = 0;
};

Point point_of(const Image& image) {
    Point p;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double v = value(image, x, y, 0);
            p.energy += v;
            p.x += v * (x + 0.5);
            p.y += v * (y + 0.5);
        }
    }
    p.x /= p.energy;
    p.y /= p.energy;
    return p;
}

TEST(Scatter, PointKeepsEnergyAndCentroid) {
    for (const double radius : {0.05, 0.7, 1.9, 2.3, 6.0, 13.7, 25.0}) {
        const auto image = scattered(
            corner_band(64, 64, 30,
                        [&](int x, int y) {
                            return std::vector{corner(1 / radius, x == 31 && y == 33 ? 5e4F : 0.0F, 0, 0)};
                        }),
            30, {.depths = 2});
        const Point p = point_of(image);
        EXPECT_NEAR(p.energy, 5e4, 5e4 * 1e-6) << radius;
        EXPECT_NEAR(p.x, 31, 0.01) << radius;
        EXPECT_NEAR(p.y, 33, 0.01) << radius;
    }
}

TEST(Scatter, PointInsideAPixelKeepsItsCentroid) {
    for (const double radius : {0.05, 1.5, 2.5, 6.0, 20.0}) {
        RecordBand band =
            corner_band(64, 64, 30, [&](int, int) { return std::vector{corner(1 / radius, 0, 0, 0)}; });
        subdivide_pixel(band, 30, 32, [&](float x, float y) {
            return corner(1 / radius, x == 30.5F && y == 32.5F ? 8.0F : 0.0F, 0, 0);
        });
        const Point p = point_of(scattered(band, 30, {.depths = 2}));
        // The point has a quarter of each of four leaves.
        EXPECT_NEAR(p.energy, 2, 0.01) << radius;
        EXPECT_NEAR(p.x, 30.5, 0.01) << radius;
        EXPECT_NEAR(p.y, 32.5, 0.01) << radius;
    }
}

TEST(Scatter, BrightLightLeavesNoTraceWhereItDoesNotReach) {
    constexpr double radius = 11;
    const auto with_light = [&](float light) {
        return scattered(
            corner_band(200, 60, 0,
                        [&](int x, int y) {
                            return std::vector{corner(1 / radius, x == 40 && y == 30 ? light : 0.01F, 0, 0)};
                        }),
            0);
    };
    const Image dark = with_light(0.01F), bright = with_light(1e9F);
    for (int x = 60; x < 200; ++x)
        EXPECT_NEAR(value(bright, x, 30, 0), value(dark, x, 30, 0), 1e-6 * 0.01) << x;
    EXPECT_GT(value(bright, 45, 30, 0), 1e6);
}

TEST(Scatter, UniformStaysUniform) {
    std::mt19937 random(11);
    for (const double largest_radius : {0.5, 5.0, 60.0, 2000.0}) {
        std::uniform_real_distribution<double> radius(0, largest_radius);
        const auto image = scattered(
            corner_band(150, 90, 0,
                        [&](int x, int y) {
                            // Random radii on the left, runs of equal radii on the right.
                            const double r = x < 50 ? radius(random) : largest_radius * (y % 3 + 1) / 3;
                            return std::vector{corner(1 / r, 0.7F, 0.1F, 123.0F)};
                        }),
            0);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                ASSERT_NEAR(value(image, x, y, 0), 0.7F, 1e-6) << largest_radius << " " << x << " " << y;
                ASSERT_NEAR(value(image, x, y, 1), 0.1F, 1e-6);
                ASSERT_NEAR(value(image, x, y, 2), 123.0F, 123e-6);
            }
        }
    }
}

// --- fast forms against slow ones
// ----------------------------------------------------------------------------------

void expect_equals_reference(const SplatTables& tables) {
    Image fast;
    scatter(tables, fast);
    const Image slow = scatter_reference(tables);
    ASSERT_EQ(fast.rgb.size(), slow.rgb.size());
    for (std::size_t i = 0; i < fast.rgb.size(); ++i) {
        const double wanted = static_cast<double>(slow.rgb[i]);
        ASSERT_NEAR(static_cast<double>(fast.rgb[i]), wanted, 1e-6 * std::max(1.0, std::abs(wanted))) << i;
    }
}

TEST(Scatter, RunsEqualTheReference) {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> colour(0, 2);
    for (const double radius : {1e-3, 0.6, 1.4, 4.0, 9.5, 33.0, 90.0, 400.0}) {
        // Runs of many lengths, some shorter than a strip.
        const RecordBand band = corner_band(170, 75, 3, [&](int x, int y) {
            const bool other = (x / 37 + y / 11) % 3 == 0;
            return std::vector{corner(other ? 1 / (radius * 0.8 + 0.3) : 1 / radius, colour(random),
                                      colour(random), colour(random))};
        });
        const auto tables = tables_of(band, 3);
        std::size_t runs = 0;
        for (int y = band.y_begin; y < band.y_end; ++y) runs += tables->row(y).runs.size();
        EXPECT_GT(runs, 0U);
        expect_equals_reference(*tables);
    }
    for (const double radius : {400.0, 3000.0}) {
        expect_equals_reference(*tables_of(
            corner_band(1300, 4, 0,
                        [&](int, int) { return std::vector{corner(1 / radius, colour(random), 0, 1)}; }),
            0));
    }
}

TEST(Scatter, SplatsEqualTheReference) {
    std::mt19937 random(23);
    const RandomOptions options{.levels = 5, .probability = 0.35, .has_w = true};
    for (const double scale : {1e-6, 0.3, 3.0, 40.0}) {
        const RecordBand band = random_band(random, -4, 41, -4, 33, options);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.3;
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            expect_equals_reference(*tables_of(band, 4, {.geometry = geometry, .model = model}));
        }
    }
}

/// Scatters each point sample with its exact CoC and position, without tables. Where leaves of different
/// sizes meet, each moves its part of a sample by a sixth of its edge towards its centre.
Image exact_scatter(const RecordBand& band, const FocusGeometry& geometry) {
    PointSamples samples;
    find_point_samples(band, band.y_begin, band.y_end, band.y_begin, band.y_end - 1, samples);
    Image image(band.width() - 1, band.height() - 1);
    std::vector<double> sums(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                             4);
    for (const PointSample& s : samples.samples) {
        const Record& r = band.records[s.first_record];
        const double radius = std::abs(geometry.coc_diameter_px(1 / static_cast<double>(r.z))) / 2;
        const double weight = static_cast<double>(s.total_weight());
        glm::dvec2 place(static_cast<double>(s.x) - band.x_begin, static_cast<double>(s.y) - band.y_begin);
        for (std::size_t q = 0; q < 4 && weight > 0; ++q) {
            const glm::dvec2 inwards(q % 2 == 0 ? -1 : 1, q / 2 == 0 ? -1 : 1);
            place +=
                static_cast<double>(s.weight[q]) / weight * static_cast<double>(s.leaf_size[q]) / 6 * inwards;
        }
        const auto rows = ellipse_coverage(Ellipse::disc(std::max(radius, 1e-4)), place.x, place.y);
        for (const CoverageRow& row : rows) {
            if (row.y < 0 || row.y >= image.height) continue;
            for (std::size_t i = 0; i < row.share.size(); ++i) {
                const int x = row.x_begin + static_cast<int>(i);
                if (x < 0 || x >= image.width) continue;
                double* sum = sums.data() +
                              4 * (static_cast<std::size_t>(row.y) * static_cast<std::size_t>(image.width) +
                                   static_cast<std::size_t>(x));
                const double h = weight * row.share[i];
                sum[0] += h * static_cast<double>(r.r);
                sum[1] += h * static_cast<double>(r.g);
                sum[2] += h * static_cast<double>(r.b);
                sum[3] += h;
            }
        }
    }
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        image.rgb[i] = static_cast<float>(sums[i / 3 * 4 + i % 3] / sums[i / 3 * 4 + 3]);
    }
    return image;
}

TEST(Scatter, SubdividedPicturesEqualEachSampleAtItsOwnPlace) {
    std::mt19937 random(29);
    for (const double radius : {2.5, 6.0, 12.5}) {
        // All leaves are 1/4 px wide, so kernels exist for the positions of all samples except those on the
        // raster's border, which have leaves on one side only.
        RecordBand band = random_band(random, 0, 50, 0, 40, {.levels = 2, .probability = 1});
        for (Record& r : band.records) r.z = static_cast<float>(1 / radius);
        const Image got = scattered(band, 0, {.depths = 2}), exact = exact_scatter(band, unit_geometry);
        const int border = static_cast<int>(radius) + 2;
        for (int y = border; y < got.height - border; ++y) {
            for (int x = border; x < got.width - border; ++x)
                ASSERT_NEAR(got.pixel(x, y)[1], exact.pixel(x, y)[1], 4e-6) << radius;
        }
    }
}

/// Moments of a border's blur, px and px^2.
struct BorderBlur {
    double place = 0, variance = 0;
};

/// Blur of a border between two colours at `edge_px`, by discs of `radius_px`. One column of pixels is
/// divided into 16 x 16 cells, the others are not.
BorderBlur border_blur(double edge_px, double radius_px) {
    constexpr int width = 80, height = 40, parts = 16;
    const int divided = static_cast<int>(edge_px);
    RecordBand band;
    band.x_end = width + 1;
    band.y_end = height + 1;
    for (int y = 0; y <= height; ++y) {
        for (int x = 0; x <= width; ++x) {
            // The right border of a pixel belongs to its neighbour, the lower border to the next row.
            const int rows = (x == divided || x == divided + 1) && y < height ? parts : 1;
            const int columns = x == divided ? parts : 1;
            for (int j = 0; j < rows; ++j) {
                for (int i = 0; i < columns; ++i) {
                    const double at = x + i / static_cast<double>(parts);
                    Record r = corner(1 / radius_px, at < edge_px ? 1.0F : 0.0F, 0, 0);
                    r.x = static_cast<float>(at);
                    r.y = static_cast<float>(y + j / static_cast<double>(parts));
                    band.records.push_back(r);
                }
            }
            band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
        }
    }
    const Image image = scattered(band, 0, {.depths = 2});
    double mean = 0, square = 0;
    for (int x = 20; x < 60; ++x) {
        const double share = static_cast<double>(image.pixel(x - 1, height / 2)[0]) -
                             static_cast<double>(image.pixel(x, height / 2)[0]);
        mean += share * x;
        square += share * x * x;
    }
    return {mean, square - mean * mean};
}

// A disc has the variance r^2 / 4 along an axis. Differences between pixels add that of a triangle, 1 / 6;
// the trapezoidal rule would add another 1 / 6.
TEST(Scatter, BordersThatLeavesAreDividedForAreNoWiderThanTheirDisc) {
    for (const double radius : {3.3, 6.2, 12.7}) {
        for (const double edge : {40.22, 40.47, 40.78}) {
            const BorderBlur got = border_blur(edge, radius);
            // Samples are 1/16 px apart.
            EXPECT_NEAR(got.place, edge, 1.0 / 32 + 0.01) << radius;
            EXPECT_NEAR(got.variance - radius * radius / 4 - 1.0 / 6, 0, 0.025) << radius << ", " << edge;
        }
    }
}

TEST(Scatter, FinePositionsAreSharedOutToNeighbouringPhases) {
    std::mt19937 random(31);
    for (const double radius : {2.5, 20.0, 300.0}) {
        RecordBand band = random_band(random, 0, 12, 0, 12, {.levels = 5, .probability = 0.35});
        for (Record& r : band.records) r.z = static_cast<float>(1 / radius);
        // The error of an edge is at most (step / radius)^2 / 8, for colours of up to 4.
        EXPECT_LT(difference(scattered(band, 0, {.depths = 2}), exact_scatter(band, unit_geometry)), 1e-3)
            << radius;
    }
}

// --- depth spacing
// -------------------------------------------------------------------------------------------------

double psnr_db(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double d = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
        sum += d * d;
    }
    return -10 * std::log10(sum / static_cast<double>(a.rgb.size()));
}

/// Tiles at random depths from 0.6 to 40 m, uniform in inverse depth.
RecordBand tiles(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> inverse_depth(1 / 40.0, 1 / 0.6),
        logarithm(std::log(0.6), std::log(40.0));
    std::vector<double> depth_m;
    for (int i = 0; i < 400; ++i)
        depth_m.push_back(i % 2 == 0 ? 1 / inverse_depth(random) : std::exp(logarithm(random)));
    std::uniform_real_distribution<float> colour(0, 1);
    std::vector<float> shade;
    for (int i = 0; i < 400; ++i) shade.push_back(colour(random));
    return corner_band(120, 90, 0, [&](int x, int y) {
        const std::size_t tile = static_cast<std::size_t>(x / 9 + 17 * (y / 9)) % 400;
        // Each tile has a checker with its own brightness.
        const float v = shade[tile] * ((x / 3 + y / 3) % 2 == 0 ? 1.0F : 0.3F);
        return std::vector{corner(depth_m[tile], v, shade[(tile + 100) % 400], 1 - v)};
    });
}

TEST(DepthSpacing, InverseStepsAreTheBetterChoiceAtEqualCost) {
    FocusGeometry geometry = lens_geometry;
    geometry.inverse_focus_per_m = 1 / 3.0;
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const RecordBand band = tiles(seed);
        const Image exact = exact_scatter(band, geometry);
        const auto error_db = [&](DepthSpacing spacing, std::optional<int> depths) {
            return psnr_db(scattered(band, 0, {.geometry = geometry, .spacing = spacing, .depths = depths}),
                           exact);
        };
        for (const int k : {8, 16, 32, 64}) {
            EXPECT_GT(error_db(DepthSpacing::inverse, k), error_db(DepthSpacing::linear, k) + 5)
                << seed << " " << k;
        }
        // The quantisation of the default has a negligible error.
        EXPECT_GT(error_db(DepthSpacing::inverse, std::nullopt), 58) << seed;
    }
}

// --- the tree of nodes
// -----------------------------------------------------------------------------------------------

/// A dark surface with a bright node behind a mirror at one corner.
RecordBand mirrored_point(double primary_z_m, double node_z_m, const Mat2& w) {
    return corner_band(80, 80, 0, [&](int x, int y) {
        std::vector nodes{corner(primary_z_m, 0, 0, 0)};
        if (x == 40 && y == 40) {
            Record node = corner(node_z_m, 100, 100, 100);
            node.path = NodePath().child(NodePath::Bounce::reflected);
            node.w = w;
            nodes.push_back(node);
        }
        return nodes;
    });
}

/// Half of the extent of the pixels that are not black, px, along x and y.
std::pair<int, int> extent(const Image& image) {
    int x_least = image.width, x_most = -1, y_least = image.height, y_most = -1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (value(image, x, y, 0) <= 1e-9) continue;
            x_least = std::min(x_least, x);
            x_most = std::max(x_most, x);
            y_least = std::min(y_least, y);
            y_most = std::max(y_most, y);
        }
    }
    return {(x_most - x_least + 1) / 2, (y_most - y_least + 1) / 2};
}

TEST(Scatter, EachDepthModelTakesItsOwnDepth) {
    // The radii are 3 px by the primary depth, 8 px by the path length and 20 px by W.
    const RecordBand band = mirrored_point(1.0 / 3, 1.0 / 8, Mat2::isotropic(20));
    const auto radius = [&](DepthModel model) { return extent(scattered(band, 0, {.model = model})).first; };
    EXPECT_NEAR(radius(DepthModel::first_hit), 3, 1);
    EXPECT_NEAR(radius(DepthModel::path), 8, 1);
    EXPECT_NEAR(radius(DepthModel::ray_differentials), 20, 1);
    for (const DepthModel model : {DepthModel::first_hit, DepthModel::path, DepthModel::ray_differentials}) {
        EXPECT_NEAR(point_of(scattered(band, 0, {.model = model})).energy, 100, 0.01);
    }
}

TEST(Scatter, MirrorSpreadsItsImageOverAnEllipse) {
    const Mat2 w{12, 4, 4, 24};
    const Image image = scattered(mirrored_point(1, 1, w), 0);
    // The half extents of the ellipse of M = -W are the lengths of the rows of M.
    const auto [across, down] = extent(image);
    EXPECT_NEAR(across, std::hypot(12, 4), 1.01);
    EXPECT_NEAR(down, std::hypot(4, 24), 1.01);
    const Point p = point_of(image);
    EXPECT_NEAR(p.energy, 100, 0.01);
    EXPECT_NEAR(p.x, 40, 0.01);
    EXPECT_NEAR(p.y, 40, 0.01);
    // The second moments of a uniform ellipse are M M^T / 4, plus 1/12 for a pixel.
    double xx = 0, xy = 0, yy = 0;
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 80; ++x) {
            const double v = value(image, x, y, 0) / p.energy, dx = x + 0.5 - p.x, dy = y + 0.5 - p.y;
            xx += v * dx * dx;
            xy += v * dx * dy;
            yy += v * dy * dy;
        }
    }
    // An error of 1/8 px of the outline changes the moments by at most a quarter of the semi-axis.
    EXPECT_NEAR(xx - 1 / 12.0, (12 * 12 + 4 * 4) / 4.0, 0.8);
    EXPECT_NEAR(xy, (12 * 4 + 4 * 24) / 4.0, 1.0);
    EXPECT_NEAR(yy - 1 / 12.0, (4 * 4 + 24 * 24) / 4.0, 1.6);
}

TEST(Scatter, FlatMirrorNeedsNoW) {
    std::mt19937 random(37);
    std::uniform_real_distribution<double> depth(0.2, 3);
    const RecordBand band = corner_band(60, 40, 0, [&](int, int) {
        std::vector nodes{corner(2, 0.1F, 0.1F, 0.1F), corner(depth(random), 0.5F, 0.2F, 0.3F)};
        nodes[1].path = NodePath().child(NodePath::Bounce::reflected);
        return nodes;
    });
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px = 9000;
    EXPECT_LT(difference(scattered(band, 0, {.geometry = geometry, .model = DepthModel::ray_differentials}),
                         scattered(band, 0, {.geometry = geometry, .model = DepthModel::path})),
              1e-6);
}

// --- limits
// ------------------------------------------------------------------------------------------------------------

TEST(Scatter, VanishingCocIsTheTracedPicture) {
    std::mt19937 random(41);
    for (const int levels : {0, 1, 3, 8}) {
        const RandomOptions options{.levels = levels, .probability = levels > 3 ? 0.3 : 0.5, .has_w = true};
        const RecordBand band = random_band(random, -2, 33, -2, 28, options);
        FocusGeometry geometry = unit_geometry;
        geometry.gain_px = 1e-3;
        for (const DepthModel model :
             {DepthModel::ray_differentials, DepthModel::path, DepthModel::first_hit}) {
            const Image image = scattered(band, 2, {.geometry = geometry, .model = model});
            for (int y = 0; y < image.height; ++y) {
                std::vector<float> row(static_cast<std::size_t>(image.width) * 3);
                picture_row(band, y, 0, image.width, row);
                for (std::size_t i = 0; i < row.size(); ++i) {
                    const double wanted = static_cast<double>(row[i]);
                    ASSERT_NEAR(static_cast<double>(image.pixel(0, y)[i]), wanted,
                                1e-6 * std::max(1.0, wanted))
                        << levels << " " << y << " " << i;
                }
            }
        }
    }
}

void expect_sane(const Image& image, double least, double most) {
    for (const float v : image.rgb) {
        ASSERT_TRUE(std::isfinite(v));
        ASSERT_GE(static_cast<double>(v), least * (1 - 1e-5));
        ASSERT_LE(static_cast<double>(v), most * (1 + 1e-5));
    }
}

TEST(Scatter, ExtremeDepthsAndFocusesAreFinite) {
    std::mt19937 random(43);
    std::uniform_real_distribution<float> colour(0.25F, 1);
    const std::vector<double> depths{infinity, 1e-6, 1e-38, 0.01, 0.03, 1, 1e6};
    const RecordBand band = corner_band(48, 32, 0, [&](int x, int y) {
        return std::vector{corner(depths[static_cast<std::size_t>(x / 7 + y / 6) % depths.size()],
                                  colour(random), colour(random), colour(random))};
    });
    for (const double inverse_focus : {0.0, 0.2, 1 / 0.03}) {
        FocusGeometry geometry = lens_geometry;
        geometry.inverse_focus_per_m = inverse_focus;
        for (const auto spacing : {DepthSpacing::inverse, DepthSpacing::linear}) {
            for (const auto k : {std::optional<int>(), std::optional<int>(7)}) {
                const auto tables =
                    tables_of(band, 0, {.geometry = geometry, .spacing = spacing, .depths = k});
                Image image;
                scatter(*tables, image);
                expect_sane(image, 0.25, 1);
                EXPECT_TRUE(std::isfinite(tables->largest_coc_px()));
            }
        }
    }
}

TEST(Scatter, CircleOfSeveralFramesIsTheMeanOfThePicture) {
    std::mt19937 random(47);
    std::uniform_real_distribution<float> colour(0, 1);
    // CoCs of several image widths, of more than the largest radius, and extreme W as near a caustic.
    for (const double radius : {500.0, 2e5, 1e9}) {
        double sum = 0;
        const RecordBand band = corner_band(64, 48, 0, [&](int, int) {
            const float v = colour(random);
            sum += static_cast<double>(v);
            return std::vector{corner(1 / radius, v, v, v)};
        });
        const Image image = scattered(band, 0);
        const double mean = sum / (65 * 49);
        // Samples at the border have half of the weight.
        for (const float v : image.rgb) ASSERT_NEAR(static_cast<double>(v), mean, 0.01) << radius;
    }
    const Image caustic = scattered(mirrored_point(1, 1, {1e20F, 3e12F, -1e7F, 1e-20F}), 0);
    expect_sane(caustic, 0, 100);
}

TEST(Scatter, NegativeColoursPassThrough) {
    const Image image =
        scattered(corner_band(20, 20, 0, [](int, int) { return std::vector{corner(0.2, -1, 2, -3)}; }), 0);
    EXPECT_NEAR(value(image, 10, 10, 0), -1, 1e-6);
    EXPECT_NEAR(value(image, 10, 10, 2), -3, 3e-6);
}

TEST(Scatter, IsTheSameForAnyNumberOfThreads) {
    std::mt19937 random(53);
    const RecordBand band =
        random_band(random, -3, 150, -3, 99, {.levels = 3, .probability = 0.2, .has_w = true});
    FocusGeometry geometry = unit_geometry;
    geometry.gain_px = 15000;
    std::vector<float> first;
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        const Image image = scattered(band, 3, {.geometry = geometry});
        if (first.empty()) first = image.rgb;
        EXPECT_EQ(image.rgb, first) << threads;
    }
}

}  // namespace
}  // namespace postlens
