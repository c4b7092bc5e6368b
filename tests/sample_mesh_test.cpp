// Records as a mesh of micro-quads: what the mesh covers, how it is drawn, and the mean of many views of it.
#include "reproject/sample_mesh.h"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <map>

#include "core/threads.h"
#include "records/quadtree.h"
#include "reproject/light_field.h"
#include "reproject/tile_raster.h"
#include "tests/motion_frame.h"
#include "tests/random_records.h"

namespace postlens::test {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr int width = 40, height = 30, overscan = 3;
constexpr double all_px = (width + 2 * overscan) * (height + 2 * overscan);

// A file of random quadtrees, each of whose records `change` may alter.
struct MadeFrame {
    template <typename Change>
    MadeFrame(const RandomOptions& options, const Change& change, std::uint32_t seed = 3) {
        std::mt19937 random(seed);
        SampleHeader h = full_header(width, height, overscan, options);
        h.film_distance_mm = 50;
        h.pixel_pitch_mm = 36.0 / width;
        band = random_frame(random, h, options);
        for (Record& r : band.records) {
            if (!options.has_w) r.path = NodePath();
            change(r);
            r.w = Mat2::isotropic(1 / r.z);
        }
        const std::filesystem::path path = folder.path() / "made.exr";
        SampleFileWriter writer(path, h, RecordCompression::none);
        writer.write(band);
        writer.finish();
        file = std::make_unique<SampleFileReader>(path);
        mesh = sample_mesh(*file);
    }
    [[nodiscard]] std::size_t leaves() const {
        PixelLeaves found;
        find_leaves(band, band.y_begin, band.y_end - 1, found);
        return found.leaves.size();
    }

    TemporaryFolder folder;
    RecordBand band;
    std::unique_ptr<SampleFileReader> file;
    SampleMesh mesh;
};

double area(const SampleMesh& mesh, const MeshBlock& b) {
    double sum = 0;
    for (std::uint32_t q = 0; q < b.quads; ++q) {
        const auto& v = mesh.quads[b.first_quad + q].vertex;
        const std::uint32_t i = b.first_vertex;
        EXPECT_EQ(mesh.y[i + v[0]], mesh.y[i + v[1]]);
        EXPECT_EQ(mesh.x[i + v[0]], mesh.x[i + v[2]]);
        EXPECT_EQ(mesh.x[i + v[1]], mesh.x[i + v[3]]);
        EXPECT_EQ(mesh.y[i + v[2]], mesh.y[i + v[3]]);
        sum += static_cast<double>(mesh.x[i + v[1]] - mesh.x[i + v[0]]) *
               static_cast<double>(mesh.y[i + v[2]] - mesh.y[i + v[0]]);
    }
    return sum;
}
double area(const SampleMesh& mesh, std::optional<std::uint32_t> id = {}) {
    double sum = 0;
    for (const MeshBlock& b : mesh.blocks) {
        if (!id || b.id == *id) sum += area(mesh, b);
    }
    return sum;
}
std::size_t quads(const SampleMesh& mesh, std::uint32_t id) {
    std::size_t sum = 0;
    for (const MeshBlock& b : mesh.blocks) sum += b.id == id ? b.quads : 0;
    return sum;
}

// How many quads hold a place that lies on no border.
int layers_at(const SampleMesh& mesh, float x, float y) {
    int n = 0;
    for (const MeshBlock& b : mesh.blocks) {
        for (std::uint32_t q = 0; q < b.quads; ++q) {
            const std::uint32_t first = b.first_vertex + mesh.quads[b.first_quad + q].vertex[0],
                                last = b.first_vertex + mesh.quads[b.first_quad + q].vertex[3];
            n += mesh.x[first] < x && x < mesh.x[last] && mesh.y[first] < y && y < mesh.y[last] ? 1 : 0;
        }
    }
    return n;
}

TEST(SampleMesh, CoversEveryPlaceOnce) {
    const MadeFrame f({.levels = 4}, [](Record& r) { r.id %= 3; });
    EXPECT_EQ(area(f.mesh), all_px);  // sums of powers of two
    std::mt19937 random(1);
    std::uniform_real_distribution<float> x(-overscan, width + overscan), y(-overscan, height + overscan);
    for (int i = 0; i < 300; ++i) EXPECT_EQ(layers_at(f.mesh, x(random), y(random)), 1);
}

TEST(SampleMesh, EverySurfaceOfACornerHasItsQuarterOfTheLeaf) {
    // Layers, ids and depths at random: whatever joins, the areas stay.
    const MadeFrame f({.levels = 3, .has_layers = true}, [](Record& r) { r.id %= 4; });
    std::map<std::pair<float, float>, int> surfaces;
    for (const Record& r : f.band.records) surfaces[{r.y, r.x}] += r.path.bits() == 0 ? 1 : 0;
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
    EXPECT_EQ(area(f.mesh), expected);
}

TEST(SampleMesh, BlocksBoundWhatIsInThem) {
    const MadeFrame f({.levels = 3, .has_layers = true}, [](Record& r) { r.id %= 4; });
    for (const MeshBlock& b : f.mesh.blocks) {
        ASSERT_LE(b.first_vertex + b.vertices, f.mesh.x.size());
        ASSERT_LE(b.first_quad + b.quads, f.mesh.quads.size());
        EXPECT_LE(b.x_max - b.x_min, SampleMesh::block_px);
        EXPECT_LE(b.y_max - b.y_min, SampleMesh::block_px);
        for (std::uint32_t i = b.first_vertex; i < b.first_vertex + b.vertices; ++i) {
            EXPECT_TRUE(b.x_min <= f.mesh.x[i] && f.mesh.x[i] <= b.x_max);
            EXPECT_TRUE(b.y_min <= f.mesh.y[i] && f.mesh.y[i] <= b.y_max);
            EXPECT_TRUE(b.inverse_z_min <= f.mesh.inverse_z[i] && f.mesh.inverse_z[i] <= b.inverse_z_max);
        }
        for (std::uint32_t q = b.first_quad; q < b.first_quad + b.quads; ++q) {
            for (const std::uint32_t v : f.mesh.quads[q].vertex) EXPECT_LT(v, b.vertices);
        }
    }
}

TEST(SampleMesh, AWallBehindABallIsOneWholeWall) {
    SceneBuilder b;
    b.add(Rectangle{{-9, -9, -7}, {18, 0, 2}, {0, 18, 0}}, glowing({0.2, 0.3, 0.4}));
    b.add(Sphere{{0.1, 0, -3}, 0.4}, glowing({0.9, 0.3, 0.1}));
    TraceSettings settings;
    settings.subdivision.levels = 3;
    settings.hidden_layers = 3;
    const TracedFrame frame(b.scene, settings);
    const SampleMesh mesh = sample_mesh(frame.file());
    EXPECT_EQ(area(mesh, 1), 64 * 48);
    RecordBand band;
    frame.file().read(0, 49, band);
    PixelLeaves found;
    find_leaves(band, 0, 48, found);
    EXPECT_EQ(quads(mesh, 1), found.leaves.size());  // none is cut
    EXPECT_LT(area(mesh, 2), 2 * 64 * 48 / 4);
    // The ball has quarters along its outline only.
    settings.hidden_layers = 0;
    const SampleMesh seen = sample_mesh(TracedFrame(b.scene, settings).file());
    EXPECT_EQ(area(seen), 64 * 48);
    // The cone about a ball is tan(asin(r / d)) wide; some 75 px of outline are known to 1/16 px.
    const double tangent2 = 0.4 * 0.4 / (0.1 * 0.1 + 3 * 3 - 0.4 * 0.4);
    EXPECT_NEAR(area(seen, 2), 3.14159 * tangent2 * px_per_m * px_per_m, 4);
}

TEST(SampleMesh, AJumpInDepthIsCutAndASlopeIsNot) {
    const auto leaves_of_column = static_cast<std::size_t>(height + 2 * overscan);
    const MadeFrame jump({}, [](Record& r) {
        r.id = 5;
        r.z = r.x < 8 ? 2 : 20;  // a tangent of 0.9 / 0.018 for a leaf of 1 px, beyond 40
    });
    EXPECT_EQ(jump.mesh.quads.size(), jump.leaves() + 3 * leaves_of_column);
    EXPECT_EQ(area(jump.mesh), all_px);
    const MadeFrame slope({}, [](Record& r) {
        r.id = 5;
        r.z = 1 / (0.3F + 0.005F * r.x);  // as tangent up to 0.005 / 0.285 * 50 / 36 * 40 < 1
    });
    EXPECT_EQ(slope.mesh.quads.size(), slope.leaves());
}

TEST(SampleMesh, AnIdSeenTwiceOnOneRayIsTwoSheets) {
    const MadeFrame f({.has_layers = true}, [](Record& r) {
        r.id = 5;
        r.z = r.layer == 0 ? 2 : 4;
    });
    // The front sheet is whole, the other where random left it.
    double front = 0;
    for (const MeshBlock& b : f.mesh.blocks) EXPECT_EQ(b.inverse_z_max, 0.5F);
    for (std::size_t i = 0; i < f.mesh.inverse_z.size(); ++i) {
        EXPECT_TRUE(f.mesh.inverse_z[i] == 0.5F || f.mesh.inverse_z[i] == 0.25F);
        front += f.mesh.inverse_z[i] == 0.5F ? 1 : 0;
    }
    EXPECT_GT(front, 0);
    std::size_t whole = 0;
    for (const MeshBlock& b : f.mesh.blocks) {
        for (std::uint32_t q = b.first_quad; q < b.first_quad + b.quads; ++q) {
            const auto& v = f.mesh.quads[q].vertex;
            // No quad reaches from sheet to sheet.
            for (const std::uint32_t k : v)
                EXPECT_EQ(f.mesh.inverse_z[b.first_vertex + k], f.mesh.inverse_z[b.first_vertex + v[0]]);
            whole += f.mesh.inverse_z[b.first_vertex + v[0]] == 0.5F ? 1 : 0;
        }
    }
    EXPECT_EQ(whole, f.leaves());
}

// Drawing -------------------------------------------------------------------------------------------------

/// All blocks in one tile from raster (0, 0), 40x30 px, sampled at `at` in each pixel.
std::unique_ptr<TileBuffer> drawn(const SampleMesh& mesh, const RasterMap& map, const glm::dvec2& at,
                                  bool backwards = false) {
    auto out = std::make_unique<TileBuffer>();
    out->clear();
    DrawScratch scratch;
    for (std::size_t i = 0; i < mesh.blocks.size(); ++i) {
        draw_block(mesh, mesh.blocks[backwards ? mesh.blocks.size() - 1 - i : i], map, 1,
                   {at.x, at.y, width, height}, scratch, *out);
    }
    return out;
}
std::size_t at_px(int x, int y) {
    return static_cast<std::size_t>(y) * TileBuffer::edge + static_cast<std::size_t>(x);
}
// Places in a pixel: centre and corners of leaves among them. Views never look at 0.
const std::vector<glm::dvec2> places{{0.5, 0.5},      {0.25, 0.75},     {0.0625, 0.5},
                                     {0.501, 0.0001}, {0.9999, 0.0625}, {0.3717, 0.6113}};

int holes(const SampleMesh& mesh, const RasterMap& map, int margin = 0) {
    int n = 0;
    for (const glm::dvec2& place : places) {
        const auto tile = drawn(mesh, map, place);
        for (int y = margin; y < height - margin; ++y) {
            for (int x = margin; x < width - margin; ++x) n += tile->inverse_z[at_px(x, y)] < 0 ? 1 : 0;
        }
    }
    return n;
}

// A plane of one id with colours that go linearly over the raster, on random quadtrees.
MadeFrame plane(double tilt_x, double tilt_y) {
    return {{.levels = 4, .probability = 0.4}, [=](Record& r) {
                r.id = 5;
                r.z = static_cast<float>(
                    1 / (0.3 + tilt_x * static_cast<double>(r.x) + tilt_y * static_cast<double>(r.y)));
                r.r = 0.25F + 0.01F * r.x;
                r.g = 0.5F - 0.01F * r.y;
                r.b = 0;
            }};
}

dmat4 raster_turn(double angle) {
    const dmat4 to_middle = glm::translate(dmat4(1), dvec3(0));
    dmat4 centre(1), back(1), turn(1);
    centre[2] = {width / 2.0, height / 2.0, 1, 0};
    back[2] = {-width / 2.0, -height / 2.0, 1, 0};
    turn[0] = {std::cos(angle), std::sin(angle), 0, 0};
    turn[1] = {-std::sin(angle), std::cos(angle), 0, 0};
    return centre * turn * back * to_middle;
}

TEST(DrawBlock, UnmovedHasNoHolesAndTheRecordsColours) {
    const MadeFrame f = plane(0.001, -0.002);
    EXPECT_EQ(holes(f.mesh, RasterMap()), 0);
    for (const glm::dvec2& place : places) {
        const auto tile = drawn(f.mesh, RasterMap(), place);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto at_x = static_cast<float>(x + place.x), at_y = static_cast<float>(y + place.y);
                const std::size_t k = at_px(x, y);
                // Shares of the corners are floats of places up to 46 in leaves of 1/16 px: 46 / 2^24 * 16.
                EXPECT_NEAR(tile->r[k], 0.25F + 0.01F * at_x, 1e-5F);
                EXPECT_NEAR(tile->g[k], 0.5F - 0.01F * at_y, 1e-5F);
                EXPECT_NEAR(tile->inverse_z[k], 0.3F + 0.001F * at_x - 0.002F * at_y, 1e-5F);
                EXPECT_EQ(tile->id[k], 5U);
                EXPECT_EQ(tile->mark[k], 1);
            }
        }
    }
}

TEST(DrawBlock, NoHolesUnderTurnsStretchesAndPerspective) {
    const MadeFrame f = plane(0.001, -0.002);
    for (const double angle : {0.001, 0.1, 0.5, 0.7853981634, 1.3})
        EXPECT_EQ(holes(f.mesh, {raster_turn(angle), Projection::perspective}, 15 /* turned-in corners */), 0)
            << angle;
    dmat4 larger(1);
    larger[0][0] = 1.7;
    larger[1][1] = 2.3;
    EXPECT_EQ(holes(f.mesh, {larger, Projection::perspective}), 0);
    dmat4 smaller(1);  // about the corner, a fifth and less
    smaller[0][0] = 0.21;
    smaller[1][1] = 0.13;
    const auto tile = drawn(f.mesh, {smaller, Projection::perspective}, {0.5, 0.5});
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 8; ++x) EXPECT_GE(tile->inverse_z[at_px(x, y)], 0);
    }
    for (const double step : {0.3, -0.3}) {  // a step of the camera: by depth
        dmat4 step_aside(1);
        step_aside[3] = {3 * step, step, step, 1};
        EXPECT_EQ(holes(f.mesh, {step_aside, Projection::perspective}, 4), 0) << step;
    }
}

TEST(DrawBlock, CracksBetweenLeavesOfDifferentSizeAreRoundingOnly) {
    // Lines stay lines, so that a corner in the middle of a neighbour's side stays on it but for its rounding
    // to 24 bits, and that of the side's ends: half of 4e-6 px each at 32 to 64 px. A pixel of leaves of 1/16
    // px has 16 such lines at most, and a look falls between with a chance of 16 * 4e-6.
    const MadeFrame f = plane(0, 0);
    const int looks = 100 * static_cast<int>(places.size()) * width * (height - 8);
    int missed = 0;
    for (int i = 0; i < 100; ++i) {
        dmat4 tilt(1);  // keeps rows as rows: the worst case
        tilt[1] = {0, 1, 1e-6 * i, 0};
        tilt[2] = {0, 0.037 * i, 1, 0};
        missed += holes(f.mesh, {tilt, Projection::perspective}, 4);
    }
    EXPECT_LE(missed, looks * 16 * 4e-6);
}

TEST(DrawBlock, TheNearestIsSeenInAnyOrder) {
    const MadeFrame f({.levels = 2, .has_layers = true}, [](Record& r) {
        r.id = r.layer + 1;
        r.z = 4 / static_cast<float>(r.id);  // deeper layers are nearer, once they are moved there
    });
    const auto a = drawn(f.mesh, RasterMap(), {0.5, 0.5}), b = drawn(f.mesh, RasterMap(), {0.5, 0.5}, true);
    int nearer = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::size_t k = at_px(x, y);
            EXPECT_EQ(a->id[k], b->id[k]);
            EXPECT_EQ(a->r[k], b->r[k]);
            EXPECT_FLOAT_EQ(a->inverse_z[k], static_cast<float>(a->id[k]) / 4);
            nearer += a->id[k] > 1 ? 1 : 0;
        }
    }
    EXPECT_GT(nearer, 100);
}

TEST(DrawBlock, WhatIsTurnedOverOrBehindIsNotDrawn) {
    const MadeFrame f = plane(0, 0);
    dmat4 mirrored(1);
    mirrored[0][0] = -1;
    mirrored[2][0] = width;
    dmat4 behind(1);
    behind[2][2] = -1;
    for (const dmat4& m : {mirrored, behind}) {
        const auto tile = drawn(f.mesh, {m, Projection::perspective}, {0.5, 0.5});
        for (const float z : tile->inverse_z) EXPECT_EQ(z, TileBuffer::nothing);
    }
}

TEST(DrawBlock, StaysWithinTheRectangleOfItsBlock) {
    const MadeFrame f({.levels = 3, .has_layers = true}, [](Record& r) { r.id %= 2; });
    dmat4 m = raster_turn(0.4);
    m[3] = {2, -3, 0.1, 1};
    const RasterMap map(m, Projection::perspective);
    DrawScratch scratch;
    auto tile = std::make_unique<TileBuffer>();
    for (const MeshBlock& b : f.mesh.blocks) {
        tile->clear();
        draw_block(f.mesh, b, map, 1, {0.5, 0.5, width, height}, scratch, *tile);
        const RasterRect rect = covered_rect(b, map);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                if (tile->inverse_z[at_px(x, y)] < 0) continue;
                // Triangles reach a thousandth beyond themselves.
                EXPECT_TRUE(rect.meets(x + 0.499, x + 0.501, y + 0.499, y + 0.501)) << x << ' ' << y;
            }
        }
    }
}

// Many views ----------------------------------------------------------------------------------------------

/// `views` views, id 5 moved by `map` in each.
LightField field_of(const SampleMesh& mesh, const std::function<RasterMap(int)>& map, int views) {
    LightField field;
    field.meshes = {&mesh};
    field.motion_classes = 2;
    field.motion_class = [](std::uint32_t id) { return id == 5 ? std::size_t{1} : std::size_t{0}; };
    field.class_marks = {0, 1};
    field.width = width;
    field.height = height;
    for (int i = 0; i < views; ++i) {
        FieldView v;
        v.sample = {(i % 8 + 0.5) / 8, (i / 8 % 8 + 0.5) / 8};
        v.uses = {{0, 1, {RasterMap(), map(i)}}};
        field.views.push_back(std::move(v));
    }
    return field;
}

TEST(LightFieldOfViews, AtRestItIsTheRecordsColours) {
    const MadeFrame f = plane(0.001, -0.002);
    dmat4 hardly(1);
    hardly[2][0] = 1e-12;  // not the identity, so that it is drawn
    const FieldPicture p = light_field(field_of(
        f.mesh, [&](int) { return RasterMap(hardly, Projection::perspective); }, 64));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // The mean of what goes linearly is its value in the middle.
            EXPECT_NEAR(p.image.pixel(x, y)[0], 0.25 + 0.01 * (x + 0.5), 1e-5);
            EXPECT_NEAR(p.image.pixel(x, y)[1], 0.5 - 0.01 * (y + 0.5), 1e-5);
            EXPECT_EQ(p.unknown[static_cast<std::size_t>(y * width + x)], 0);
            EXPECT_EQ(p.touched[static_cast<std::size_t>(y * width + x)], 1);
        }
    }
}

TEST(LightFieldOfViews, WhatStandsStillIsNotTouched) {
    const MadeFrame f = plane(0, 0);
    const FieldPicture p = light_field(field_of(
        f.mesh, [](int) { return RasterMap(); }, 64));
    for (const std::uint8_t t : p.touched) EXPECT_EQ(t, 0);
}

TEST(LightFieldOfViews, SaysWhereNothingIsKnown) {
    const MadeFrame f = plane(0, 0);
    // Half of the views see it moved 10 px to the right: the records begin 3 px left of the frame.
    dmat4 right(1);
    right[2][0] = 10;
    const FieldPicture p = light_field(field_of(
        f.mesh, [&](int i) { return i % 2 == 0 ? RasterMap() : RasterMap(right, Projection::perspective); },
        64));
    for (int x = 0; x < width; ++x) {
        const std::size_t k = static_cast<std::size_t>(12 * width + x);
        EXPECT_NEAR(p.unknown[k], x < 7 ? 0.5 : 0, 1e-6) << x;
        EXPECT_EQ(p.touched[k], x < 7 ? 0xFF : 1);
    }
}

TEST(LightFieldOfViews, SameBitsForAnyNumberOfThreads) {
    const MadeFrame f({.levels = 3, .has_layers = true}, [](Record& r) {
        r.id = 4 + r.id % 2;
        r.z = r.id == 5 ? 2 : 5;
    });
    std::vector<FieldPicture> pictures;
    std::vector<SampleMesh> meshes;
    for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        meshes.push_back(sample_mesh(*f.file));
        pictures.push_back(light_field(field_of(
            meshes.back(), [](int i) { return RasterMap(raster_turn(0.004 * i), Projection::perspective); },
            64)));
        EXPECT_EQ(meshes[0].x, meshes.back().x);
        EXPECT_EQ(meshes[0].inverse_z, meshes.back().inverse_z);
        EXPECT_EQ(pictures[0].image.rgb, pictures.back().image.rgb);
        EXPECT_EQ(pictures[0].touched, pictures.back().touched);
        EXPECT_EQ(pictures[0].unknown, pictures.back().unknown);
    }
}

}  // namespace
}  // namespace postlens::test
