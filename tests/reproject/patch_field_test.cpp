// Sheets, patches and the mean of their views: coverage by sheets, and fast drawing against slow drawing.
#include "reproject/patch_field.h"

#include <cmath>
#include <gtest/gtest.h>
#include <mutex>
#include <random>

#include "core/threads.h"
#include "records/quadtree.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_reach.h"
#include "reproject/sheets/sheet_subset.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {
namespace {

constexpr int width = 40, height = 30, overscan = 3;

/// The sheets of a file of random quadtrees, whose records are modified by `change`.
struct MadeSheets {
    template <typename Change>
    MadeSheets(const RandomOptions& options, const Change& change, std::uint32_t seed = 3) {
        std::mt19937 random(seed);
        SampleHeader h = full_header(width, height, overscan, options);
        h.film_distance_mm = 50;
        h.pixel_pitch_mm = 36.0 / width;
        band = random_frame(random, h, options);
        for (Record& r : band.records) {
            if (!options.has_w) r.path = NodePath();
            change(r);
            if (r.path.bits() == 0) r.w = Mat2::isotropic(1 / r.z);
        }
        const std::filesystem::path path = folder.path() / "made.exr";
        SampleFileWriter writer(path, h, RecordCompression::none);
        writer.write(band);
        writer.finish();
        file = std::make_unique<SampleFileReader>(path);
        sheets = tree_sheets(*file, 0, {});
    }
    TemporaryFolder folder;
    RecordBand band;
    std::unique_ptr<SampleFileReader> file;
    TreeSheets sheets;
};

/// The texel at a position in a pixel, (x, y) in [0, 1) px; none if the sheet has nothing there.
std::uint32_t texel_at(const SheetMesh& mesh, std::uint32_t node, double x, double y) {
    while (!SheetNode::empty(node) && (node & SheetNode::leaf) == 0) {
        x *= 2;
        y *= 2;
        const bool right = x >= 1, down = y >= 1;
        node = mesh.nodes[node + (right ? 1U : 0U) + (down ? 2U : 0U)];
        if (right) x -= 1;
        if (down) y -= 1;
    }
    return SheetNode::empty(node) ? SeenTile::no_texel : node & ~SheetNode::leaf;
}

// In layer 0, every position belongs to exactly one sheet, and the pixel means equal the traced image.
TEST(Sheets, CoverEveryPixelOnceWithThePinholesColours) {
    const MadeSheets f({.levels = 3}, [](Record& r) { r.id %= 4; });
    const SheetMesh& mesh = f.sheets.primary;
    const Image picture = f.file->picture();
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
    for (std::size_t k = 0; k < sum.size(); ++k) {
        EXPECT_NEAR(sum[k][3], 1, 1e-9) << k;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto expected = static_cast<double>(picture.rgb[3 * k + c]);
            EXPECT_NEAR(sum[k][c], expected, 1e-5 * std::max(1.0, std::abs(expected))) << k;
        }
    }
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

TEST(PatchField, AMotionAndItsLensAreOneMap) {
    const MadeSheets f({.levels = 1}, [](Record& r) {
        r.id = 5;
        r.z = 2;
    });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {10, 0.1});
    glm::dmat4 m(0.5);  // 3 px to the right, at half of the depth
    m[2][0] = 1.5;
    m[3][3] = 1;
    const LensShift shift{{8, 0}, 0.1, {}};
    for (const Patch& p : mesh.patches) {
        PatchPlace place;
        ASSERT_TRUE(place_patch(mesh, p, RasterMap(m, Projection::perspective), shift, place));
        EXPECT_NEAR(place.from.x, mesh.corner(p).x + 3 + (0.1 - 1.0) * 8, 1e-4);
        EXPECT_NEAR(place.inverse_z.x, 1, 1e-6);
    }
}

TEST(PatchField, WhatIsNotWantedStaysUnknown) {
    const MadeSheets f({.levels = 1}, [](Record& r) { r.id = 5; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {1, 0.1});
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.width = width;
    field.height = height;
    PatchView v;
    v.uses = {{0, 1, {}}};
    field.sets.resize(2);
    for (PatchViews& set : field.sets) set.views = {v};
    field.sets[0].wanted = [](int, int, int, int) { return false; };
    field.sets[1].picture = 1;
    std::vector<PatchPicture> pictures(2, PatchPicture(width, height));
    patch_field(field, pictures);
    for (const float u : pictures[0].unknown) EXPECT_EQ(u, 1);
    for (const float u : pictures[1].unknown) EXPECT_EQ(u, 0);
}

/// Records the lines that are traced.
class NotedLines : public SightRays {
  public:
    void trace(std::span<const SightLine> lines, const LightElsewhere& /*less*/,
               std::span<std::array<float, 3>> radiance) const override {
        const std::scoped_lock lock(mutex_);
        noted_.insert(noted_.end(), lines.begin(), lines.end());
        std::fill(radiance.begin(), radiance.end(), std::array<float, 3>{});
    }
    [[nodiscard]] bool steady(NodePath, std::uint32_t) const override { return true; }
    [[nodiscard]] const std::vector<SightLine>& noted() const { return noted_; }

  private:
    mutable std::mutex mutex_;
    mutable std::vector<SightLine> noted_;
};

// A check ray follows the line of its view, with the light and lobe samples of the view's set.
TEST(PatchField, ChecksLookAlongTheLinesOfTheirViews) {
    const MadeSheets f({.levels = 1}, [](Record& r) { r.id = 5; });
    const PatchMesh mesh = cut_patches(f.sheets.primary, {1, 0.1});
    NotedLines rays;
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.width = width;
    field.height = height;
    field.recorded_end = {width, height};
    field.sets.resize(1);
    for (const double at : {0.25, 0.75}) {
        PatchView v;
        v.sample = v.lens_point = glm::dvec2(at);
        v.light_before = at;
        v.set = 7;
        v.number = static_cast<std::uint32_t>(field.sets[0].views.size());
        v.uses = {{0, 1, {}}};
        field.sets[0].views.push_back(v);
    }
    field.sets[0].rays = &rays;
    field.sets[0].checked = [](int, int, std::vector<std::uint32_t>& views) { views = {0, 1}; };
    std::vector<PatchPicture> pictures(1, PatchPicture(width, height));
    patch_field(field, pictures);
    // Every view sample of every pixel is either replaced or checked by a ray.
    EXPECT_EQ(rays.noted().size(), static_cast<std::size_t>(2 * width * height));
    for (const SightLine& line : rays.noted()) {
        ASSERT_EQ(line.set, 7U);
        ASSERT_LT(line.view, 2U);
        const double at = line.view == 0 ? 0.25 : 0.75;
        EXPECT_EQ(line.place, glm::dvec2(at));
        EXPECT_EQ(line.lens, glm::dvec2(at));
        EXPECT_EQ(line.light_before, at);
    }
}

}  // namespace
}  // namespace postlens::test
