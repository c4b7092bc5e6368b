// Moving patches: their size for a motion, absence of holes after rotations and translations, and marks of
// pixels that moving surfaces touch.
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/threads.h"
#include "records/quadtree.h"
#include "reproject/no_rays.h"
#include "reproject/patch_field.h"
#include "reproject/patches/motion_strain.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/patches/patch_sweep.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::moving_patches_test {
namespace {

using glm::dmat4;

constexpr int width = 40, height = 30, overscan = 3;
constexpr double all_px = (width + 2 * overscan) * (height + 2 * overscan);
constexpr std::uint32_t moving_id = 5;

/// The sheets of a file of random quadtrees, whose records are modified by `change`.
struct MovingSheets {
    template <typename Change>
    MovingSheets(const RandomOptions& options, const Change& change) {
        std::mt19937 random(3);
        SampleHeader h = full_header(width, height, overscan, options);
        h.film_distance_mm = 50;
        h.pixel_pitch_mm = 36.0 / width;
        band = random_frame(random, h, options);
        for (Record& r : band.records) {
            r.path = NodePath();
            change(r);
            r.w = Mat2::isotropic(1 / r.z);
        }
        const std::filesystem::path path = folder.path() / "made.exr";
        SampleFileWriter writer(path, h, RecordCompression::none);
        writer.write(band);
        writer.finish();
        file = std::make_unique<SampleFileReader>(path);
        sheets = tree_sheets(*file, 0, {}).primary;
    }
    TemporaryFolder folder;
    RecordBand band;
    std::unique_ptr<SampleFileReader> file;
    SheetMesh sheets;
};

/// A plane of one id with colours that are linear over the raster, on random quadtrees.
MovingSheets plane(double tilt_x, double tilt_y) {
    return {{.levels = 3, .probability = 0.4}, [=](Record& r) {
                r.id = moving_id;
                r.z = static_cast<float>(
                    1 / (0.3 + tilt_x * static_cast<double>(r.x) + tilt_y * static_cast<double>(r.y)));
                r.r = 0.25F + 0.01F * r.x;
                r.g = 0.5F - 0.01F * r.y;
                r.b = 0;
            }};
}

/// Area of a pixel, px^2, that a node of its quadtree covers.
double area(const SheetMesh& mesh, std::uint32_t node, double size = 1) {
    if (SheetNode::empty(node)) return 0;
    if ((node & SheetNode::leaf) != 0) return size * size;
    double sum = 0;
    for (std::uint32_t k = 0; k < 4; ++k) sum += area(mesh, mesh.nodes[node + k], size / 2);
    return sum;
}
double area(const SheetMesh& mesh) {
    double sum = 0;
    for (const std::uint32_t root : mesh.fine) sum += area(mesh, root);
    return sum;
}

dmat4 raster_turn(double angle, const glm::dvec2& about = {width / 2.0, height / 2.0}) {
    dmat4 centre(1), back(1), turn(1);
    centre[2] = {about.x, about.y, 1, 0};
    back[2] = {-about.x, -about.y, 1, 0};
    turn[0] = {std::cos(angle), std::sin(angle), 0, 0};
    turn[1] = {-std::sin(angle), std::cos(angle), 0, 0};
    return centre * turn * back;
}
/// A translation of the camera, whose displacement on the raster depends on the depth.
dmat4 step_aside(double px_m) {
    dmat4 m(1);
    m[3][0] = px_m;
    return m;
}
RasterMap map_of(const dmat4& m) {
    return {m, Projection::perspective};
}

/// A pinhole with these motions of moving_id.
PatchLens lens_for(const std::vector<RasterMap>& motions) {
    StrainOfMotions strain{{}, [](std::uint32_t id) { return id == moving_id ? std::size_t{1} : 0; }};
    for (const RasterMap& m : motions) strain.views.push_back({RasterMap(), m});
    PatchLens lens;
    lens.follow_px = PatchLens::all_follow;
    lens.motion = std::move(strain);
    return lens;
}

// Positions in a pixel, including the centre and corners of leaves.
const std::vector<glm::dvec2> places{{0.5, 0.5},      {0.25, 0.75},     {0.0625, 0.5},
                                     {0.501, 0.0001}, {0.9999, 0.0625}, {0.3717, 0.6113}};

SeenTile drawn(const PatchMesh& mesh, const RasterMap& map, const glm::dvec2& sample) {
    SeenTile out;
    out.clear();
    for (const Patch& p : mesh.patches) {
        PatchPlace place;
        if (place_patch(mesh, p, map, {}, place))
            draw_patch(mesh, p, place, {0, 0, width, height, sample}, out);
    }
    return out;
}
int holes(const SheetMesh& sheets, const RasterMap& map, int margin = 0) {
    const PatchMesh mesh = cut_patches(sheets, lens_for({map}));
    int n = 0;
    for (const glm::dvec2& place : places) {
        const SeenTile tile = drawn(mesh, map, place);
        for (int y = margin; y < height - margin; ++y) {
            for (int x = margin; x < width - margin; ++x)
                n += tile.inverse_z[static_cast<std::size_t>(y * SeenTile::edge + x)] < 0 ? 1 : 0;
        }
    }
    return n;
}

TEST(MovingSheets, EverySurfaceOfACornerHasItsQuarterOfTheLeaf) {
    // Layers, ids and depths are random. Areas are conserved for any connection of cells. No id overlaps
    // itself.
    const MovingSheets f({.levels = 3, .has_layers = true},
                         [](Record& r) { r.id = r.id % 4 + 4 * static_cast<std::uint32_t>(r.layer); });
    std::map<std::pair<float, float>, int> surfaces;
    for (const Record& r : f.band.records) ++surfaces[{r.y, r.x}];
    PixelLeaves found;
    find_leaves(f.band, f.band.y_begin, f.band.y_end - 1, found);
    double expected = 0;
    for (const Leaf& leaf : found.leaves) {
        for (const std::uint32_t corner : leaf.corner) {
            const PointSample& s = found.points.samples[corner];
            expected +=
                0.25 * static_cast<double>(leaf.size) * static_cast<double>(leaf.size) * surfaces[{s.y, s.x}];
        }
    }
    EXPECT_GT(expected, all_px);
    EXPECT_EQ(area(f.sheets), expected);  // sums of powers of two
}

TEST(MovingSheets, AnIdSeenTwiceOnOneRayIsTwoSheets) {
    const MovingSheets f({.has_layers = true}, [](Record& r) {
        r.id = moving_id;
        r.z = r.layer == 0 ? 2 : 20;  // a slope of more than 88.6 degrees within a pixel
    });
    double front_px2 = 0;
    for (const Sheet& s : f.sheets.sheets) {
        ASSERT_EQ(s.inverse_z_min, s.inverse_z_max);  // no sheet connects the two depths
        for (int k = 0; s.inverse_z_min == 0.5F && k < s.width * s.height; ++k)
            front_px2 += area(f.sheets, f.sheets.fine[s.first_cell + static_cast<std::size_t>(k)]);
    }
    EXPECT_EQ(front_px2, all_px);
}

// Compares the derivatives of maps of both projections with differences.
TEST(RasterMap, TangentIsTheMapToFirstOrder) {
    dmat4 m = raster_turn(0.4);
    m[3] = {9, -7, 0.2, 1.1};
    m[0][2] = 0.003;
    m[2] += glm::dvec4(3, 1, 0.1, 0.02);
    const RasterPoint p{12, 7, 0.4};
    const glm::dvec2 slope(0.01, -0.02);
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
        const RasterMap map(m, projection);
        const auto to = map.tangent(p, slope, {1, 1});
        ASSERT_TRUE(to);
        const auto at = [&](double x, double y) {
            return *map({p.x + x, p.y + y, p.inverse_z + slope.x * x + slope.y * y});
        };
        constexpr double h = 1e-3;
        const auto expect = [&](const RasterPoint& by, const RasterPoint& after, const RasterPoint& before) {
            EXPECT_NEAR(by.x, (after.x - before.x) / (2 * h), 1e-5);
            EXPECT_NEAR(by.y, (after.y - before.y) / (2 * h), 1e-5);
            EXPECT_NEAR(by.inverse_z, (after.inverse_z - before.inverse_z) / (2 * h), 1e-6);
        };
        EXPECT_NEAR(to->at.x, at(0, 0).x, 1e-12);
        EXPECT_NEAR(to->at.y, at(0, 0).y, 1e-12);
        EXPECT_NEAR(to->at.inverse_z, at(0, 0).inverse_z, 1e-12);
        expect(to->by_x, at(h, 0), at(-h, 0));
        expect(to->by_y, at(0, h), at(0, -h));
    }
    // A patch that extends behind the camera has no tangent, even if its centre is in front of it.
    dmat4 near(1);
    near[0][2] = -0.1;
    EXPECT_TRUE(map_of(near).tangent({5, 0, 1}, {0, 0}, {4, 4}));
    EXPECT_FALSE(map_of(near).tangent({5, 0, 1}, {0, 0}, {6, 4}));
}

// A motion parallel to the film displaces by the px per 1/m in the matrix's last column. A rotation in the
// film does not depend on depth and is linear. A pan is nonlinear by about the differences of its map.
TEST(StrainOfMotions, IsTheMostOfAllViews) {
    const SheetKey key{{}, 0, moving_id};
    const auto of = [&](const std::vector<RasterMap>& motions, const SheetKey& k) {
        return lens_for(motions).motion(k, {20, 15, 0.3}, {0, 0}, {8, 8});
    };
    const MotionStrain aside = of({map_of(step_aside(7)), map_of(step_aside(-11))}, key);
    EXPECT_NEAR(aside.px_m, 11, 1e-9);
    EXPECT_EQ(aside.bend_px, 0);
    const MotionStrain turned = of({map_of(raster_turn(0.5))}, key);
    EXPECT_NEAR(turned.px_m, 0, 1e-9);
    EXPECT_EQ(turned.bend_px, 0);
    dmat4 pan(1);
    pan[0][2] = 0.001;
    const RasterMap panned = map_of(pan);
    const auto at = [&](double x, double y) {
        const auto to = panned({x, y, 0.3});
        return glm::dvec2(to->x, to->y);
    };
    const auto to = panned.tangent({20, 15, 0.3}, {0, 0}, {8, 8});
    const glm::dvec2 corner = at(28, 23), first_order = glm::dvec2(to->at.x, to->at.y) +
                                                        8.0 * glm::dvec2(to->by_x.x, to->by_x.y) +
                                                        8.0 * glm::dvec2(to->by_y.x, to->by_y.y);
    const double off = glm::length(corner - first_order), bend = of({panned}, key).bend_px;
    EXPECT_GT(bend, off);
    EXPECT_LT(bend, 2 * off);
    EXPECT_EQ(of({RasterMap()}, key).px_m, 0);
    EXPECT_EQ(of({map_of(step_aside(7))}, {{}, 0, moving_id + 1}).px_m, 0);
}

// A curved surface whose displacement depends on depth: every cell must be within the tolerance of the
// position by its own depth. With patches for a pinhole without motion, which are as large as possible, the
// error is one pixel.
TEST(MovingPatches, AreCutAsFineAsTheMotionAsks) {
    const MovingSheets f({.levels = 1}, [](Record& r) {
        r.id = moving_id;
        const float dx = (r.x - 20) / 20, dy = (r.y - 15) / 20;
        r.z = 1 / (0.3F + 0.2F * (dx * dx + dy * dy));
    });
    const RasterMap map = map_of(step_aside(60));
    const auto worst_px = [&](const PatchLens& lens) {
        const PatchMesh mesh = cut_patches(f.sheets, lens);
        double worst = 0;
        for (const Patch& p : mesh.patches) {
            PatchPlace place;
            EXPECT_TRUE(place_patch(mesh, p, map, {}, place));
            const Sheet& s = mesh.sheet(p);
            for (int y = 0; y < p.height; ++y) {
                for (int x = 0; x < p.width; ++x) {
                    const std::size_t k =
                        s.first_cell + static_cast<std::size_t>((p.y + y) * s.width + p.x + x);
                    if (f.sheets.fine[k] == SheetNode::none) continue;
                    const glm::dvec2 at(x + 0.5, y + 0.5), from = mesh.corner(p) + at,
                                                           got = place.from + place.move * at;
                    const auto own = map({from.x, from.y, static_cast<double>(f.sheets.planes[k].value)});
                    worst = std::max(worst, std::hypot(got.x - own->x, got.y - own->y));
                }
            }
        }
        return worst;
    };
    PatchLens pinhole = lens_for({});
    EXPECT_LT(worst_px(lens_for({map})), pinhole.exact_px + 1e-6);
    pinhole.motion = {};
    EXPECT_GT(worst_px(pinhole), 1);
}

TEST(MovingPatches, LeaveNoHolesUnderTurnsStretchesAndPerspective) {
    const MovingSheets f = plane(0.001, -0.002);
    EXPECT_EQ(holes(f.sheets, RasterMap()), 0);
    for (const double angle : {0.001, 0.1, 0.5, 0.7853981634, 1.3})
        EXPECT_EQ(holes(f.sheets, map_of(raster_turn(angle)), 15 /* turned-in corners */), 0) << angle;
    dmat4 larger(1);
    larger[0][0] = 1.7;
    larger[1][1] = 2.3;
    EXPECT_EQ(holes(f.sheets, map_of(larger)), 0);
    dmat4 smaller(1);  // scales by 0.21 and 0.13 about the corner
    smaller[0][0] = 0.21;
    smaller[1][1] = 0.13;
    const SeenTile tile =
        drawn(cut_patches(f.sheets, lens_for({map_of(smaller)})), map_of(smaller), {0.5, 0.5});
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 8; ++x)
            EXPECT_GE(tile.inverse_z[static_cast<std::size_t>(y * SeenTile::edge + x)], 0);
    }
    for (const double step : {0.3, -0.3}) {
        dmat4 step_back(1);
        step_back[3] = {3 * step, step, step, 1};
        EXPECT_EQ(holes(f.sheets, map_of(step_back), 4), 0) << step;
    }
    for (int i = 0; i < 20; ++i) {
        dmat4 tilt(1);  // maps rows to rows
        tilt[1] = {0, 1, 5e-6 * i, 0};
        tilt[2] = {0, 0.185 * i, 1, 0};
        EXPECT_EQ(holes(f.sheets, map_of(tilt), 4), 0) << i;
    }
}

TEST(MovingPatches, TurnedOverOrBehindTheCameraTheyAreNotDrawn) {
    const MovingSheets f = plane(0, 0);
    dmat4 mirrored(1);
    mirrored[0][0] = -1;
    mirrored[2][0] = width;
    dmat4 behind(1);
    behind[2][2] = -1;
    for (const dmat4& m : {mirrored, behind}) {
        const SeenTile tile = drawn(cut_patches(f.sheets, lens_for({map_of(m)})), map_of(m), {0.5, 0.5});
        for (const std::uint32_t t : tile.texel) EXPECT_EQ(t, SeenTile::no_texel);
    }
}

// Sweeps --------------------------------------------------------------------------------------------------

// With rays, the views of a time span are bounded by its first and last view. Between these, a patch that
// turns about a distant point leaves the line between its two positions by up to 3 px here.
TEST(PatchSweep, ContainsAFastTurnInAllViewsOfATimeSpan) {
    const MovingSheets f = plane(0, 0);
    constexpr int views = 16;  // all in the first time span
    std::vector<RasterMap> maps;
    // The path of the patches is vertical in the middle, so that only its curvature moves them to the left.
    for (int i = 0; i < views; ++i)
        maps.push_back(map_of(raster_turn(0.1 * ((i + 0.5) / views - 0.5), {3000, height / 2.0})));
    const PatchMesh mesh = cut_patches(f.sheets, lens_for(maps));
    const NoRays rays;
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.motion_class = [](std::uint32_t id) { return id == moving_id ? std::size_t{1} : std::size_t{0}; };
    PatchViews set;
    set.rays = &rays;
    for (int i = 0; i < views; ++i) {
        PatchView v;
        v.light_before = (i + 0.5) / views / 64;
        v.uses = {{0, 1, {RasterMap(), maps[static_cast<std::size_t>(i)]}}};
        set.views.push_back(std::move(v));
    }
    field.sets.push_back(std::move(set));
    const PatchSweep sweep(field);
    for (const Patch& patch : mesh.patches) {
        const RasterRect all = sweep.of(mesh, patch, 0);
        for (int i = 0; i < views; ++i) {
            PatchPlace place;
            ASSERT_TRUE(place_patch(mesh, patch, maps[static_cast<std::size_t>(i)], {}, place));
            const RasterRect one = covered(patch, place);
            ASSERT_TRUE(one.x_min >= all.x_min && one.x_max <= all.x_max && one.y_min >= all.y_min &&
                        one.y_max <= all.y_max)
                << "view " << i;
        }
    }
}

// Marks ---------------------------------------------------------------------------------------------------

/// The mean of `views` views, in each of which moving_id is moved by `map`.
PatchPicture seen(const SheetMesh& sheets, const std::function<RasterMap(int)>& map, int views = 64) {
    std::vector<RasterMap> maps;
    for (int i = 0; i < views; ++i) maps.push_back(map(i));
    const PatchMesh mesh = cut_patches(sheets, lens_for(maps));
    PatchField field;
    field.instants = {{&mesh, nullptr}};
    field.motion_class = [](std::uint32_t id) { return id == moving_id ? std::size_t{1} : std::size_t{0}; };
    field.class_marks = {0, 1};
    field.width = width;
    field.height = height;
    PatchViews set;
    for (int i = 0; i < views; ++i) {
        PatchView v;
        v.sample = {(i % 8 + 0.5) / 8, (i / 8 % 8 + 0.5) / 8};
        v.uses = {{0, 1, {RasterMap(), maps[static_cast<std::size_t>(i)]}}};
        set.views.push_back(std::move(v));
    }
    field.sets.push_back(std::move(set));
    PatchPicture out(width, height);
    patch_field(field, std::span(&out, 1));
    return out;
}

TEST(PatchMarks, AtRestItIsTheRecordsColours) {
    const MovingSheets f = plane(0.001, -0.002);
    dmat4 hardly(1);
    hardly[2][0] = 1e-12;  // not the identity
    const PatchPicture p = seen(f.sheets, [&](int) { return map_of(hardly); });
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // The mean of a linear function over a pixel is its value at the centre.
            EXPECT_NEAR(p.image.pixel(x, y)[0], 0.25 + 0.01 * (x + 0.5), 1e-5);
            EXPECT_NEAR(p.image.pixel(x, y)[1], 0.5 - 0.01 * (y + 0.5), 1e-5);
            EXPECT_EQ(p.unknown[static_cast<std::size_t>(y * width + x)], 0);
            EXPECT_EQ(p.touched[static_cast<std::size_t>(y * width + x)], 1);
        }
    }
}

TEST(PatchMarks, WhatStandsStillIsNotTouched) {
    MovingSheets f({.levels = 2}, [](Record& r) { r.id = r.x < 20 ? 1 : moving_id; });
    dmat4 down(1);
    down[2][1] = 2;
    const PatchPicture p = seen(f.sheets, [&](int) { return map_of(down); });
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // Leaves at the border belong to both sides.
            if (x == 19 || x == 20) continue;
            EXPECT_EQ(p.touched[static_cast<std::size_t>(y * width + x)], x < 19 ? 0 : 1) << x << ' ' << y;
        }
    }
}

TEST(PatchMarks, TellWhatWasRecordedAndHasGone) {
    // The moving surface leaves the image, and a hole remains at its former position.
    const MovingSheets f = plane(0, 0);
    dmat4 away(1);
    away[2][0] = 1000;
    const PatchPicture p = seen(f.sheets, [&](int) { return map_of(away); });
    for (std::size_t k = 0; k < p.touched.size(); ++k) {
        EXPECT_EQ(p.touched[k], 0xFF);
        EXPECT_EQ(p.unknown[k], 1);
    }
}

TEST(PatchMarks, SayWhereNothingIsKnown) {
    const MovingSheets f = plane(0, 0);
    // Half of the views see the surface displaced by 10 px to the right. The records begin 3 px left of the
    // frame.
    dmat4 right(1);
    right[2][0] = 10;
    const PatchPicture p = seen(f.sheets, [&](int i) { return i % 2 == 0 ? RasterMap() : map_of(right); });
    for (int x = 0; x < width; ++x) {
        const std::size_t k = static_cast<std::size_t>(12 * width + x);
        EXPECT_NEAR(p.unknown[k], x < 7 ? 0.5 : 0, 1e-6) << x;
        EXPECT_EQ(p.touched[k], x < 7 ? 0xFF : 1);
    }
}

TEST(PatchMarks, SameBitsForAnyNumberOfThreads) {
    std::vector<PatchPicture> pictures;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const MovingSheets f({.levels = 3, .has_layers = true}, [](Record& r) {
            r.id = 4 + r.id % 2;
            r.z = r.id == moving_id ? 2 : 5;
        });
        pictures.push_back(seen(f.sheets, [](int i) { return map_of(raster_turn(0.004 * i)); }));
        EXPECT_EQ(pictures[0].image.rgb, pictures.back().image.rgb);
        EXPECT_EQ(pictures[0].touched, pictures.back().touched);
        EXPECT_EQ(pictures[0].unknown, pictures.back().unknown);
    }
}

}  // namespace
}  // namespace postlens::test::moving_patches_test
