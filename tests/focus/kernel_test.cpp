// The kernels of the scatter method, and the table that holds them.
#include "focus/responses/kernel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "focus/responses/response_model.h"
#include "lens/ellipse_coverage.h"

namespace postlens::test::kernel_test {
namespace {

constexpr KernelReach far{100000, 100000};

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
    for (double radius_px = 0.3; radius_px < 5000; radius_px *= 1.01) {
        const Ellipse kept = table.outline(KernelKey::ellipse(Ellipse::disc(radius_px), true));
        const double step_px = radius_px < 8 ? 1.0 / 64 : radius_px < 4000 ? 1.0 / 16 : 1.0 / 4;
        EXPECT_LE(std::abs(kept.half_height - radius_px), step_px / 2 + 1e-12) << radius_px;
        EXPECT_EQ(kept.half_height, kept.half_chord);
    }
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
    for (const std::int32_t fineness : {1, 2}) {
        for (const std::int32_t size : {0, 1, 2}) {
            const KernelKey key{.is_disc = false,
                                .fineness = fineness,
                                .half_height = size,
                                .half_chord = 64000 - size,
                                .top_displacement = 1,
                                .phase_x = 16,
                                .phase_y = -16};
            EXPECT_TRUE(seen.try_emplace(key.packed(), key).second);
        }
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

}  // namespace
}  // namespace postlens::test::kernel_test
