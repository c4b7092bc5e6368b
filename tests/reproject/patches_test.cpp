// Patches: positions, cuts, and fast drawing against slow drawing.
#include "reproject/patches/patches.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <utility>
#include <vector>

#include "core/job.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_reach.h"
#include "tests/reproject/made_sheets.h"
#include "tests/support/random_records.h"

namespace postlens::test::patches_test {
namespace {

/// Draws a patch pixel by pixel, in double.
void draw_slowly(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const glm::dvec2& sample,
                 std::vector<double>& z, std::vector<std::uint32_t>& texel) {
    if (glm::determinant(place.move) <= 0) return;
    const SheetMesh& sheets = *mesh.sheets;
    const Sheet& s = mesh.sheet(patch);
    const glm::dmat2 back = glm::inverse(place.move);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::dvec2 p = back * (glm::dvec2(x, y) + sample - place.from);
            if (p.x < 0 || p.y < 0 || p.x >= patch.width || p.y >= patch.height) continue;
            const int i = static_cast<int>(p.x), j = static_cast<int>(p.y);
            const std::size_t cell =
                s.first_cell + static_cast<std::size_t>((patch.y + j) * s.width + patch.x + i);
            const std::uint32_t t =
                texel_at(sheets, (patch.coarse ? sheets.coarse : sheets.fine)[cell], p.x - i, p.y - j);
            const double depth =
                std::max(0.0, place.inverse_z.x + place.inverse_z.y * p.x + place.inverse_z.z * p.y);
            const std::size_t k = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
            if (t == SeenTile::no_texel || depth <= z[k]) continue;
            z[k] = depth;
            texel[k] = t;
        }
    }
}

// Positions within 0.02 px of a border may differ, because patches overlap by this distance. If each cell is
// a separate patch, this is 8 % of its area.
TEST(Patches, FastDrawingIsWhatSlowDrawingGives) {
    for (const double radius_px : {1.0, 9.0}) {
        const MadeSheets f({.levels = 3, .has_layers = true}, [](Record& r) {
            r.id %= 3;
            r.z = 1.5F + 0.4F * static_cast<float>(r.id) + 0.3F * static_cast<float>(r.layer) + 0.004F * r.x;
        });
        const PatchLens lens{radius_px, 0.3};
        const PatchMesh mesh = cut_patches(f.sheets.primary, lens);
        ASSERT_FALSE(mesh.patches.empty());
        std::size_t different = 0, seen = 0;
        for (const glm::dvec2 q : {glm::dvec2(0.7, 0.2), glm::dvec2(-0.3, -0.9), glm::dvec2(0)}) {
            const LensShift shift{radius_px * q, lens.inverse_focus_per_m, {}};
            const glm::dvec2 sample(0.371, 0.611);
            SeenTile fast;
            fast.clear();
            std::vector<double> z(static_cast<std::size_t>(width) * height, -1);
            std::vector<std::uint32_t> texel(z.size(), SeenTile::no_texel);
            for (const Patch& p : mesh.patches) {
                PatchPlace place;
                ASSERT_TRUE(place_patch(mesh, p, {}, shift, place));
                draw_patch(mesh, p, place, {0, 0, width, height, sample}, fast);
                draw_slowly(mesh, p, place, sample, z, texel);
            }
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const std::size_t k = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x),
                                      t = static_cast<std::size_t>(y) * SeenTile::edge +
                                          static_cast<std::size_t>(x);
                    seen += texel[k] != SeenTile::no_texel ? 1 : 0;
                    different += fast.texel[t] != texel[k] ? 1 : 0;
                }
            }
        }
        EXPECT_GT(seen, 3 * width * height / 2);
        EXPECT_LT(static_cast<double>(different) / static_cast<double>(seen), 0.08) << radius_px;
    }
}

// Patches that are skipped for a view of a tile must not be visible in it. Many are skipped, since the tile
// is a tenth of the raster.
TEST(Patches, AViewMissesOnlyWhatDrawsNothing) {
    for (const bool has_w : {false, true}) {
        const MadeSheets f({.levels = 2, .has_w = has_w}, [](Record& r) { r.id %= 3; });
        const PatchLens lens{6, 0.3};
        const PatchMesh mesh = cut_patches(has_w ? f.sheets.deeper : f.sheets.primary, lens);
        ASSERT_FALSE(mesh.patches.empty());
        std::size_t missed = 0;
        for (const glm::dvec2 q : {glm::dvec2(6, 0), glm::dvec2(-4, -4), glm::dvec2(0)}) {
            const LensShift shift{q, lens.inverse_focus_per_m, {0.5, -0.25}};
            const glm::dvec2 all = shift.inverse_focus_per_m * q + shift.offset_px;
            const TilePlace tile{5, 7, 12, 10, {0.1, 0.9}};
            for (const Patch& p : mesh.patches) {
                const PatchReach reach = patch_reach(mesh, p, {6, 4}, glm::length(all));
                if (!reach.bounds(glm::vec2(q), glm::vec2(all)).misses(5, 5 + 12, 7, 7 + 10)) continue;
                ++missed;
                PatchPlace place;
                ASSERT_TRUE(place_patch(mesh, p, {}, shift, place));
                const RasterRect r = covered(p, place);
                EXPECT_TRUE(r.x_max < 5 || r.x_min > 5 + 12 || r.y_max < 7 || r.y_min > 7 + 10);
                SeenTile seen;
                seen.clear();
                draw_patch(mesh, p, place, tile, seen);
                for (const std::uint32_t t : seen.texel) ASSERT_EQ(t, SeenTile::no_texel);
            }
        }
        EXPECT_GT(missed, mesh.patches.size());  // of three times this number
    }
}

// The point at which light from a point source meets a patch on its way to a pixel must equal the point that
// the view from the same lens point sees.
TEST(Patches, LieWhereTheEyesOfAPointsRaysSeeThem) {
    const MadeSheets f({.levels = 2, .has_w = true}, [](Record& r) { r.id %= 3; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {3.0, 0.4});
    const PointRays rays{{17.3, 11.8}, glm::dmat2(0.9, 0.2, -0.1, 1.3), 0.4};
    int placed = 0;
    for (const Patch& patch : mesh.patches) {
        PatchPlace by_rays, by_eye;
        if (!place_patch(mesh, patch, rays, by_rays)) continue;
        ++placed;
        const glm::dvec2 half(patch.width / 2.0, patch.height / 2.0);
        const auto error_px = [&](const glm::dvec2& place) {
            const glm::dvec2 pixel = by_rays.from + by_rays.move * place;
            const LensShift eye{rays.lens_px_per_px * (pixel - rays.at), rays.inverse_focus_per_m, {}};
            EXPECT_TRUE(place_patch(mesh, patch, RasterMap(), eye, by_eye));
            return glm::length(by_eye.from + by_eye.move * place - pixel);
        };
        EXPECT_LT(error_px(half), 1e-6 * (1 + glm::length(by_rays.from)));
        // The map is exact to first order about the centre, so the error decreases with the square.
        const glm::dvec2 aside(0.3, -0.2);
        const double far = error_px(half + aside), near = error_px(half + aside / 100.0);
        EXPECT_LT(near, far / 5000 + 1e-9 * (1 + glm::length(by_rays.from)));
        EXPECT_EQ(by_rays.inverse_z, by_eye.inverse_z);
    }
    EXPECT_GT(placed, 50);
}

// A surface through the depth of the light has no finite image there, so it is cut.
TEST(Patches, AreCutWhereTheyComeCloseToTheLight) {
    constexpr double light = 0.4, nearest = 0.41;
    const MadeSheets f({.levels = 1}, [](Record& r) {
        r.id = 5;
        r.z = 1 / (0.2F + 0.015F * r.x + 0.005F * r.y);
    });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {20, 0.9});
    // x - at = (I - (0.9 - w) L) (p - at) = 2 (w - 0.4) (p - at).
    const PointRays rays{{3.3, 1.8}, glm::dmat2(2), 0.9};
    std::size_t parts = 0, cells = 0, nearer = 0;
    for (const Patch& patch : mesh.patches) {
        std::vector<PlacedPatch> placed;
        place_nearer(mesh, patch, rays, light, nearest, placed);
        const CellPlane& plane = mesh.planes[patch.first_plane];
        const auto w = [&](double x, double y) {
            return static_cast<double>(plane.value) + static_cast<double>(plane.x) * (x - patch.x) +
                   static_cast<double>(plane.y) * (y - patch.y);
        };
        std::map<std::pair<int, int>, int> found;
        for (const auto& [part, place] : placed) {
            const double low = w(part.x, part.y), high = w(part.x + part.width, part.y + part.height),
                         x = part.x + part.width / 2.0, y = part.y + part.height / 2.0;
            if (part.width > 1 || part.height > 1) {
                EXPECT_LE(high - light, 2.000001 * (low - light));
            }
            EXPECT_GT(w(x, y), nearest);
            const glm::dvec2 at = mesh.corner(patch) + glm::dvec2(x - patch.x, y - patch.y),
                             exact = rays.at + (at - rays.at) / (2 * (w(x, y) - light)),
                             got = place.from + place.move * glm::dvec2(part.width / 2.0, part.height / 2.0);
            EXPECT_LT(glm::length(got - exact), 1e-6 * (1 + glm::length(exact)));
            for (int j = part.y; j < part.y + part.height; ++j) {
                for (int i = part.x; i < part.x + part.width; ++i) ++found[{i, j}];
            }
        }
        for (int j = patch.y; j < patch.y + patch.height; ++j) {
            for (int i = patch.x; i < patch.x + patch.width; ++i) {
                ++cells;
                const bool is_nearer = w(i + 0.5, j + 0.5) > nearest;
                nearer += is_nearer ? 1 : 0;
                if (is_nearer) {
                    EXPECT_EQ(found[std::pair(i, j)], 1);
                }
                if (w(i + 1, j + 1) <= nearest) {
                    EXPECT_EQ(found[std::pair(i, j)], 0);
                }
            }
        }
        parts += placed.size();
    }
    EXPECT_GT(nearer, cells / 8);
    EXPECT_LT(nearer, cells * 7 / 8);
    EXPECT_LT(parts, nearer / 2);
}

// A plane is reprojected exactly, so no patch is smaller than its square.
TEST(Patches, APlaneIsCutNoFurtherThanSquares) {
    const MadeSheets f({.levels = 1}, [](Record& r) {
        r.id = 5;
        r.z = 1 / (0.5F + 0.002F * r.x - 0.001F * r.y);
    });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {20, 0.1});
    EXPECT_EQ(mesh.patches.size(), f.sheets.primary.sheets.size());
    const LensShift shift{{14, -9}, 0.1, {0.5, 0.25}};
    for (const Patch& p : mesh.patches) {
        PatchPlace place;
        ASSERT_TRUE(place_patch(mesh, p, {}, shift, place));
        for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(p.width, p.height)}) {
            const glm::dvec2 from = mesh.corner(p) + at;
            const double inverse_z = 0.5 + 0.002 * from.x - 0.001 * from.y;
            const glm::dvec2 expected = from + (0.1 - inverse_z) * shift.lens_px + shift.offset_px,
                             got = place.from + place.move * at;
            EXPECT_NEAR(got.x, expected.x, 0.01);
            EXPECT_NEAR(got.y, expected.y, 0.01);
        }
    }
}

}  // namespace
}  // namespace postlens::test::patches_test
