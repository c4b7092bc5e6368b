// Sheets: each pixel is covered once, each row is reported once, and a subset keeps its texels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "records/quadtree.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sheets/sheet_subset.h"
#include "tests/reproject/made_sheets.h"
#include "tests/support/random_records.h"

namespace postlens::test::sheets_test {
namespace {

/// For each pixel, the sum of the colours of all texels of primary nodes times their areas, px^2, and the sum
/// of these areas.
std::vector<std::array<double, 4>> pixel_sums(const MadeSheets& f) {
    const SheetMesh& mesh = f.sheets.primary;
    constexpr int steps = 32;  // finer than the quarters of the finest leaves, 1/16 px
    std::vector<std::array<double, 4>> sum(static_cast<std::size_t>(width) * height);
    for (const Sheet& s : mesh.sheets) {
        for (int j = 0; j < s.height; ++j) {
            for (int i = 0; i < s.width; ++i) {
                const int x = s.x + i, y = s.y + j;
                if (x < 0 || y < 0 || x >= width || y >= height) continue;
                const std::uint32_t root =
                    mesh.fine[s.first_cell + static_cast<std::size_t>(j * s.width + i)];
                for (int k = 0; k < steps * steps; ++k) {
                    const int column = k % steps, row = k / steps;
                    const std::uint32_t t = texel_at(mesh, root, (column + 0.5) / steps, (row + 0.5) / steps);
                    if (t == SeenTile::no_texel) continue;
                    auto& to = sum[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
                    to[0] += static_cast<double>(mesh.texels[t].r) / (steps * steps);
                    to[1] += static_cast<double>(mesh.texels[t].g) / (steps * steps);
                    to[2] += static_cast<double>(mesh.texels[t].b) / (steps * steps);
                    to[3] += 1.0 / (steps * steps);
                }
            }
        }
    }
    return sum;
}

void expect_colours(const std::vector<std::array<double, 4>>& sum, const Image& picture) {
    for (std::size_t k = 0; k < sum.size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto expected = static_cast<double>(picture.rgb[3 * k + c]);
            EXPECT_NEAR(sum[k][c], expected, 1e-5 * std::max(1.0, std::abs(expected))) << k;
        }
    }
}

// In layer 0, every position belongs to exactly one sheet, and the pixel means equal the traced image.
TEST(Sheets, CoverEveryPixelOnceWithThePinholesColours) {
    const MadeSheets f({.levels = 3}, [](Record& r) { r.id %= 4; });
    const std::vector<std::array<double, 4>> sum = pixel_sums(f);
    for (std::size_t k = 0; k < sum.size(); ++k) EXPECT_NEAR(sum[k][3], 1, 1e-9) << k;
    expect_colours(sum, f.file->picture());
}

// At some samples, black parts of the object are recorded behind its visible part. A sample apart, both could
// be one surface. At the same sample they are two, and the sheets keep both.
TEST(Sheets, KeepWhatAnObjectHasBehindItself) {
    const MadeSheets f({.levels = 3, .has_layers = true}, [](Record& r) {
        r.id = 1;
        r.z = r.layer == 0 ? 4 : 4.8F;
        if (r.layer != 0) r.r = r.g = r.b = 0;
    });
    const std::vector<std::array<double, 4>> sum = pixel_sums(f);
    double area = 0;
    for (const auto& s : sum) area += s[3];
    EXPECT_GT(area, 1.1 * width * height);
    expect_colours(sum, f.file->picture());
}

TEST(Sheets, TellOfEveryRowOnceAndInOrder) {
    const MadeSheets f({.levels = 2}, [](Record&) {});
    int next = f.file->y_begin();
    std::size_t records = 0;
    const auto rows = [&](const RecordBand& band, int y_begin, int y_end) {
        EXPECT_EQ(y_begin, next);
        next = y_end;
        records +=
            band.offsets[band.pixel(band.x_begin, y_end)] - band.offsets[band.pixel(band.x_begin, y_begin)];
    };
    const TreeSheets again = tree_sheets(*f.file, 0, {}, {rows, {}});
    EXPECT_EQ(next, f.file->y_end());
    EXPECT_EQ(records, f.band.records.size());
    EXPECT_EQ(again.primary.texels.size(), f.sheets.primary.texels.size());
}

TEST(Sheets, TellOfTheLeavesOfEveryRowOnce) {
    const MadeSheets f({.levels = 2}, [](Record&) {});
    // Numbers of leaves in a row of pixels, and their coverage.
    struct Row {
        int times = 0;
        std::size_t leaves = 0;
        double area_px2 = 0;
    };
    const int y_begin = f.file->y_begin();
    const auto rows = static_cast<std::size_t>(f.file->y_end() - 1 - y_begin);
    const auto fill = [&](std::vector<Row>& to) {
        return [&to, y_begin](const RecordBand& band, int first, int last, const PixelLeaves& leaves) {
            for (int y = first; y < last; ++y) {
                Row& row = to[static_cast<std::size_t>(y - y_begin)];
                ++row.times;
                const std::size_t k = band.pixel(band.x_begin, y) - band.pixel(band.x_begin, first);
                const auto pixels = static_cast<std::size_t>(band.width());
                for (std::uint32_t i = leaves.leaf_offsets[k]; i < leaves.leaf_offsets[k + pixels]; ++i) {
                    ++row.leaves;
                    row.area_px2 += static_cast<double>(leaves.leaves[i].size * leaves.leaves[i].size);
                }
            }
        };
    };
    std::vector<Row> with_sheets(rows), alone(rows);
    (void)tree_sheets(*f.file, 0, {}, {{}, fill(with_sheets)});
    tell({{}, fill(alone)}, f.band, y_begin, f.file->y_end());
    for (std::size_t y = 0; y < rows; ++y) {
        EXPECT_EQ(with_sheets[y].times, 1) << y;
        EXPECT_EQ(alone[y].times, 1) << y;
        EXPECT_EQ(with_sheets[y].leaves, alone[y].leaves) << y;
        EXPECT_EQ(with_sheets[y].area_px2, f.band.width() - 1) << y;
        EXPECT_EQ(alone[y].area_px2, f.band.width() - 1) << y;
    }
}

TEST(Sheets, SomeOfThemHaveWhatTheyHadAmongAll) {
    const MadeSheets f({.levels = 3, .has_w = true}, [](Record& r) { r.id %= 5; });
    for (const SheetMesh* mesh : {&f.sheets.primary, &f.sheets.deeper}) {
        ASSERT_GT(mesh->sheets.size(), 10U);
        ASSERT_GT(mesh->bright.size(), 10U);
        std::vector<std::uint8_t> wanted(mesh->sheets.size());
        std::vector<std::uint32_t> old;
        for (std::uint32_t i = 1; i < wanted.size(); i += 1 + i % 3) {
            wanted[i] = 1;
            old.push_back(i);
        }
        const SheetMesh some = sheet_subset(*mesh, wanted);
        ASSERT_EQ(some.sheets.size(), old.size());
        EXPECT_EQ(some.values, mesh->values);
        for (std::uint32_t i = 0; i < old.size(); ++i) {
            const Sheet &now = some.sheets[i], &was = mesh->sheets[old[i]];
            EXPECT_TRUE(now.key == was.key && now.x == was.x && now.y == was.y && now.depth == was.depth);
            ASSERT_TRUE(now.width == was.width && now.height == was.height);
            const auto cells = static_cast<std::uint32_t>(now.width * now.height);
            for (std::uint32_t c = 0; c < cells; ++c) {
                for (int k = 0; k < 64; ++k) {
                    const int column = k % 8, row = k / 8;
                    const double x = (column + 0.5) / 8, y = (row + 0.5) / 8;
                    for (const auto lists : {&SheetMesh::fine, &SheetMesh::coarse}) {
                        const std::uint32_t a = texel_at(some, (some.*lists)[now.first_cell + c], x, y),
                                            b = texel_at(*mesh, (mesh->*lists)[was.first_cell + c], x, y);
                        ASSERT_EQ(a == SeenTile::no_texel, b == SeenTile::no_texel);
                        if (a == SeenTile::no_texel) continue;
                        const Texel &p = some.texels[a], &q = mesh->texels[b];
                        EXPECT_TRUE(p.r == q.r && p.g == q.g && p.b == q.b && p.children() == q.children());
                        EXPECT_EQ(p.sheet(), i);
                        if (!mesh->below.empty()) {
                            EXPECT_EQ(some.below[a], mesh->below[b]);
                        }
                    }
                }
                for (std::size_t v = 0; v < mesh->values; ++v) {
                    const CellPlane &p = some.planes[(now.first_cell + c) * mesh->values + v],
                                    &q = mesh->planes[(was.first_cell + c) * mesh->values + v];
                    EXPECT_TRUE(p.value == q.value && p.x == q.x && p.y == q.y);
                }
            }
            const auto light = [](const SheetMesh& of, std::uint32_t sheet) {
                double sum = 0;
                for (const Highlight& h : of.bright)
                    sum += h.sheet == sheet ? static_cast<double>(h.rgb[1]) : 0;
                return sum;
            };
            EXPECT_EQ(light(some, i), light(*mesh, old[i]));
        }
        // The radiance of a bright texel that is not in its lights stays in the texel.
        for (const BrightTexel& b : some.bright_texels) {
            double green = static_cast<double>(b.rgb[1]);
            for (std::uint32_t l = b.first_light; l < b.first_light + b.lights; ++l) {
                EXPECT_EQ(some.bright[l].sheet, some.texels[b.texel].sheet());
                green += static_cast<double>(some.bright[l].rgb[1]) / static_cast<double>(b.area);
            }
            EXPECT_NEAR(green, static_cast<double>(some.texels[b.texel].g), 1e-5 * std::max(1.0, green));
        }
        EXPECT_EQ(sheet_subset(*mesh, std::vector<std::uint8_t>(mesh->sheets.size(), 1)).texels.size(),
                  mesh->texels.size());
    }
}

}  // namespace
}  // namespace postlens::test::sheets_test
