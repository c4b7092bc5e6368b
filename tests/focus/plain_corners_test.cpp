// Lookups for many corners at once give the same results as a computation for each corner.
#include "focus/scatter/plain_corners.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "focus/responses/level_table.h"
#include "tests/focus/focus_records.h"
#include "tests/support/random_records.h"

namespace postlens::test::plain_corners_test {
namespace {

TEST(LevelTable, HasTheLevelsOfItsDefinition) {
    const LevelTable& table = LevelTable::the();
    // Tests radii at the beginning of each level, to the last bit on both sides, and between levels.
    std::uint32_t begun = 0;
    for (double low = 0; low < 300; low += 1.0 / 64) {
        double below = low, from = low + 1.0 / 64;
        const std::uint32_t level = LevelTable::nearest_level(below);
        EXPECT_EQ(table.level_of(below), level) << below;
        if (LevelTable::nearest_level(from) == level) continue;
        while (std::nextafter(below, from) < from) {
            const double middle = below + (from - below) / 2;
            (LevelTable::nearest_level(middle) == level ? below : from) = middle;
        }
        for (const double at : {below, from, -below, -from})
            EXPECT_EQ(table.level_of(at), LevelTable::nearest_level(at)) << at;
        ++begun;
    }
    EXPECT_GT(begun, 500U);
    for (const double at : {2048.0, 5e4, 2e5, 2.1e5, 1e30})
        EXPECT_EQ(table.level_of(at), LevelTable::nearest_level(at)) << at;
}

TEST(LevelTable, HasTheSameForManyAsForEach) {
    FocusGeometry geometry = unit_geometry;
    geometry.inverse_focus_per_m = 0.5;
    std::vector<double> inverse;
    for (double scale : {1.0, 30.0, 1e4}) {
        for (int i = -500; i < 500; ++i) inverse.push_back(scale * i / 150);
    }
    std::vector<std::uint32_t> level(inverse.size());
    // With and without values beyond the table.
    for (const std::size_t count : {std::size_t{1000}, inverse.size(), std::size_t{7}, std::size_t{0}}) {
        LevelTable::the().levels_of(geometry, inverse.data(), count, level.data());
        for (std::size_t i = 0; i < count; ++i)
            EXPECT_EQ(level[i], LevelTable::the().level_of(geometry.coc_diameter_px(inverse[i])))
                << inverse[i];
    }
}

/// The tables of a band, with its plain corners handled separately or with all others.
std::unique_ptr<SplatTables> tables(const RecordBand& band, const FocusGeometry& geometry, bool apart) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end};
    const RasterWindow picture{band.x_begin, band.x_end - 1, band.y_begin, band.y_end - 1};
    auto out = std::make_unique<SplatTables>(
        source, picture, geometry, DepthLevels(geometry, range_of(band), DepthSpacing::inverse, std::nullopt),
        DepthModel::ray_differentials);
    std::vector<PointSamples> samples;
    std::vector<PlainCorners> plain;
    for (int y = band.y_begin; y < band.y_end; y += FrameRows::rows_per_task) {
        const int end = std::min(y + FrameRows::rows_per_task, band.y_end);
        PointSamples& found = samples.emplace_back();
        find_point_samples(band, y, end, band.y_begin, band.y_end - 1, found);
        PlainCorners& corners = plain.emplace_back();
        find_plain_corners(band, found, corners);
        if (apart) continue;
        std::fill(corners.inverse_depth.begin(), corners.inverse_depth.end(), PlainCorners::not_plain);
        corners.others.clear();
        corners.other_begin.assign(1, 0);
        const auto width = static_cast<std::size_t>(band.width());
        for (std::size_t row = 0; row < corners.rows.size(); ++row) {
            corners.rows[row] = {};
            for (std::uint32_t i = found.offsets[row * width]; i < found.offsets[(row + 1) * width]; ++i)
                corners.others.push_back(i);
            corners.other_begin.push_back(static_cast<std::uint32_t>(corners.others.size()));
        }
    }
    out->add_rows({&band, band.y_begin, band.y_end, samples, plain});
    out->finish();
    return out;
}

TEST(PlainCorners, GiveTheSameTablesAsAmongAllOthers) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::size_t plain = 0, others = 0;
    for (const double scale : {0.2, 3.0, 300.0}) {
        // The band has runs, single corners, mirrors, black nodes, background, depths close to 0 and
        // subdivided pixels.
        RecordBand band = corner_band(70, 30, 0, [&](int x, int y) {
            const double z_m = (x / 9 + y / 7) % 3 == 0 ? 2 : 0.3 + 3 * static_cast<double>(uniform(random));
            std::vector<Record> nodes{corner(z_m, uniform(random), uniform(random), uniform(random) - 0.1F)};
            if (x % 11 == 3) nodes[0].z = std::numeric_limits<float>::infinity();
            if (x % 13 == 5) nodes[0].z = 1e-38F;
            if (x % 5 == 0 || y % 6 == 0) {
                Record node = corner(4, y % 4 == 0 ? 0.0F : 0.5F, 0, 0);
                node.path = NodePath().child(NodePath::Bounce::reflected);
                if (x % 10 == 0) node.w = {0.3F, 0.05F, -0.1F, 0.7F};
                nodes.push_back(node);
            }
            return nodes;
        });
        for (int i = 3; i < 30; i += 4)
            subdivide_pixel(band, 2 * i, i, [&](float, float) { return corner(1.5, 1, 0.5F, 0.25F); });
        PointSamples samples;
        find_point_samples(band, band.y_begin, band.y_end, band.y_begin, band.y_end - 1, samples);
        PlainCorners found;
        find_plain_corners(band, samples, found);
        others += found.others.size();
        plain += samples.samples.size() - found.others.size();

        FocusGeometry geometry = unit_geometry;
        geometry.gain_px *= scale;
        geometry.inverse_focus_per_m = 0.4;
        const auto apart = tables(band, geometry, true), together = tables(band, geometry, false);
        EXPECT_EQ(apart->largest_coc_px(), together->largest_coc_px());
        EXPECT_EQ(apart->any_negative(), together->any_negative());
        EXPECT_EQ(apart->levels_used(), together->levels_used());
        for (int y = band.y_begin; y < band.y_end; ++y) {
            const SplatRow &a = apart->row(y), &b = together->row(y);
            ASSERT_EQ(a.runs.size(), b.runs.size()) << y;
            for (std::size_t i = 0; i < a.runs.size(); ++i) {
                ASSERT_EQ(a.runs[i].begin, b.runs[i].begin);
                ASSERT_EQ(a.runs[i].end, b.runs[i].end);
                ASSERT_EQ(a.runs[i].kernel, b.runs[i].kernel);
                for (int c = 0; c < 3; ++c) {
                    const float *of_a = apart->raster_row(c, y), *of_b = together->raster_row(c, y);
                    for (int x = a.runs[i].begin; x < a.runs[i].end; ++x) ASSERT_EQ(of_a[x], of_b[x]) << x;
                }
            }
            ASSERT_EQ(a.splats.size(), b.splats.size()) << y;
            for (std::size_t i = 0; i < a.splats.size(); ++i) {
                ASSERT_EQ(a.splats[i].x, b.splats[i].x);
                ASSERT_EQ(a.splats[i].r, b.splats[i].r);
                ASSERT_EQ(a.splats[i].g, b.splats[i].g);
                ASSERT_EQ(a.splats[i].b, b.splats[i].b);
                ASSERT_EQ(a.splats[i].weight, b.splats[i].weight);
            }
        }
        Image from_apart, from_together;
        scatter(*apart, from_apart);
        scatter(*together, from_together);
        EXPECT_EQ(from_apart.rgb, from_together.rgb);
    }
    EXPECT_GT(plain, 2000U);
    EXPECT_GT(others, 1000U);
}

}  // namespace
}  // namespace postlens::test::plain_corners_test
