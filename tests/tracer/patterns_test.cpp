// Textures and shadows between the corners of a cell that none of the corners shows.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "records/sample_file.h"
#include "scene/texel_ranges.h"
#include "tests/support/motion_frame.h"
#include "tests/support/quads.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::patterns_test {
namespace {

using glm::dvec3;

ImageTexture noise(int width, int height, std::mt19937& random) {
    ImageTexture out;
    out.width = width;
    out.height = height;
    std::uniform_real_distribution<float> value(0, 1);
    for (int i = 0; i < 3 * width * height; ++i) out.rgb.push_back(value(random));
    return out;
}

int texel_of(int at, int count, bool wraps) {
    return wraps ? ((at % count) + count) % count : std::clamp(at, 0, count - 1);
}
ColourRange looked_at_one_by_one(const ImageTexture& image, int x0, int x1, int y0, int y1, bool wrap_x,
                                 bool wrap_y) {
    ColourRange out;
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const int k =
                3 * (texel_of(y, image.height, wrap_y) * image.width + texel_of(x, image.width, wrap_x));
            const float* rgb = image.rgb.data() + k;
            out.add({rgb[0], rgb[1], rgb[2]});
        }
    }
    return out;
}
bool holds(const ColourRange& a, const ColourRange& b) {
    return glm::all(glm::lessThanEqual(a.low, b.low)) && glm::all(glm::greaterThanEqual(a.high, b.high));
}

TEST(TexelRanges, AreThoseOfTheTexelsAndLittleMore) {
    std::mt19937 random(7);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {13, 9}, {64, 37}, {200, 150}}) {
        const ImageTexture image = noise(width, height, random);
        const TexelRanges ranges(image.rgb, width, height);
        std::uniform_int_distribution<int> x(-width, 2 * width), y(-height, 2 * height), across(0, width / 2),
            down(0, height / 2), coin(0, 1);
        for (int i = 0; i < 400; ++i) {
            const int x0 = x(random), y0 = y(random), x1 = x0 + across(random), y1 = y0 + down(random);
            const bool wrap_x = coin(random) != 0, wrap_y = coin(random) != 0;
            const ColourRange got = ranges.of(image.rgb, x0, x1, y0, y1, wrap_x, wrap_y),
                              exact = looked_at_one_by_one(image, x0, x1, y0, y1, wrap_x, wrap_y);
            const int longer = std::max(x1 - x0, y1 - y0) + 1,
                      more = longer <= 9 ? 0 : static_cast<int>(std::ceil(0.4 * longer));
            EXPECT_TRUE(holds(got, exact));
            // Texels outside continue the border, whose neighbours are inside.
            const auto inside = [](int v, int count, bool wraps) {
                return wraps ? v : std::clamp(v, 0, count - 1);
            };
            EXPECT_TRUE(holds(
                looked_at_one_by_one(image, inside(x0, width, wrap_x) - more,
                                     inside(x1, width, wrap_x) + more, inside(y0, height, wrap_y) - more,
                                     inside(y1, height, wrap_y) + more, wrap_x, wrap_y),
                got));
        }
    }
}

TEST(TextureRange, OfACheckerIsOneCellsColourOrBoth) {
    Checker c;
    c.size = {0.5, 0.5, INFINITY};
    c.offset = {0.1, 0, 0};
    c.even = {0.9, 0.8, 0.7};
    c.odd = {0.1, 0.2, 0.3};
    const Texture texture(c);
    const auto range = [&](const dvec3& low, const dvec3& high) { return texture.range(low, high); };
    EXPECT_EQ(range({0.11, 0.01, -9}, {0.59, 0.49, 9}).low, c.even);
    EXPECT_EQ(range({0.11, 0.01, -9}, {0.59, 0.49, 9}).high, c.even);
    EXPECT_EQ(range({0.61, 0.01, 0}, {0.7, 0.02, 0}).high, c.odd);
    // The ends are two cells apart and have the same colour.
    EXPECT_EQ(range({0.11, 0.01, 0}, {1.15, 0.01, 0}).low, c.odd);
    EXPECT_EQ(range({0.11, 0.01, 0}, {1.15, 0.01, 0}).high, c.even);
    EXPECT_EQ(range({0.2, 0.4, 0}, {0.2, 0.6, 0}).low, c.odd);
}

TEST(TextureRange, OfAPictureHoldsAllThatIsLookedUpBetween) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1), size(0, 0.3);
    for (const bool nearest : {false, true}) {
        ImageTexture image = noise(50, 31, random);
        image.nearest = nearest;
        image.repeat = {1.5, 1};
        const Texture texture(image);
        for (int i = 0; i < 100; ++i) {
            const dvec3 low(2 * unit(random) - 0.5, 2 * unit(random) - 0.5, 0),
                high = low + dvec3(size(random), size(random), 0);
            const ColourRange range = texture.range(low, high);
            for (int k = 0; k < 40; ++k) {
                const dvec3 at = low + (high - low) * dvec3(unit(random), unit(random), 0),
                            c = texture.colour_at(at);
                ColourRange one;
                one.add(c - 1e-7);
                one.add(c + 1e-7);
                EXPECT_TRUE(holds({range.low - 2e-7, range.high + 2e-7}, one));
            }
        }
    }
}

/// A wall at 4 m with a checker whose cells are half a pixel wide, so that all corners show the same colour.
Scene fine_wall() {
    SceneBuilder b;
    const double px = 4 * 36 / 50.0 / 64;
    Checker c;
    c.size = {px / 2, px / 2, INFINITY};
    c.offset = {-0.1 * px, -0.1 * px, 0};
    c.even = dvec3(0.9);
    c.odd = dvec3(0.1);
    Material wall = glowing(dvec3(1));
    wall.emission_texture = std::make_shared<const Texture>(c);
    b.add(square({0, 0, -4}, {0, 0, 1}, 10), wall);
    return b.scene;
}

TEST(CornersAndPatterns, ACheckerIsSeenThoughAllCornersHaveOneColour) {
    TraceSettings settings;
    settings.subdivision.levels = 4;
    const TracedFrame frame(fine_wall(), settings);
    // Each colour fills half of every pixel. A pixel has two borders along each axis; leaves of 1/16 px that
    // they cut have an error of at most half of the contrast: 0.8 * 2 * 2 / 16 / 2.
    const Image picture = frame.file().picture();
    for (const float v : picture.rgb) EXPECT_NEAR(v, 0.5F, 0.1F);
    settings.subdivision.levels = 0;
    for (const float v : TracedFrame(fine_wall(), settings).file().picture().rgb) EXPECT_EQ(v, 0.9F);
}

// Corners of one colour do not show the texture between them; such leaves are marked, unless they are
// divided.
TEST(CornersAndPatterns, TextureFinerThanTheSamplesIsMarked) {
    const auto marked_share = [](const Scene& scene, int levels) {
        TraceSettings settings;
        settings.subdivision.levels = levels;
        const TracedFrame frame(scene, settings);
        EXPECT_TRUE(frame.file().header().has_marks);
        RecordBand band;
        frame.file().read(frame.file().y_begin(), frame.file().y_end(), band);
        std::size_t marked = 0;
        for (const Record& r : band.records) marked += r.mark == RecordMark::fine_texture ? 1 : 0;
        return static_cast<double>(marked) / static_cast<double>(band.records.size());
    };
    EXPECT_EQ(marked_share(fine_wall(), 0), 1);
    // A pixel has two borders along each axis, and most leaves of 1/16 px lie between borders.
    const double divided = marked_share(fine_wall(), 4);
    EXPECT_GT(divided, 0.1);
    EXPECT_LT(divided, 0.95);
    Scene wide = fine_wall();
    Checker one_cell;
    one_cell.size = dvec3(1000);
    one_cell.offset = dvec3(500);
    for (Material& m : wide.materials) m.emission_texture = std::make_shared<const Texture>(one_cell);
    EXPECT_EQ(marked_share(wide, 0), 0);
    SceneBuilder plain;
    plain.add(square({0, 0, -4}, {0, 0, 1}, 10), glowing(dvec3(0.5)));
    EXPECT_FALSE(TracedFrame(plain.scene).file().header().has_marks);
}

/// A wall at 4 m of two boards of one object. Their gap is 0.4 px wide and lies between two columns of
/// corners.
Scene boards_with_gap(bool of_one_mesh) {
    SceneBuilder b;
    const double px = 4 * 36 / 50.0 / 64, left = 0.3 * px, right = 0.7 * px;
    const auto quad = [](double x0, double x1) {
        return Quad{dvec3(x0, -10, -4), dvec3(x1, -10, -4), dvec3(x1, 10, -4), dvec3(x0, 10, -4)};
    };
    if (of_one_mesh) {
        b.add(mesh_of({quad(-10, left), quad(right, 10)}), glowing(dvec3(0.5)));
    } else {
        b.add(mesh_of({quad(-10, left)}), glowing(dvec3(0.5)));
        b.add(mesh_of({quad(right, 10)}), glowing(dvec3(0.5)));
        b.scene.objects[1].id = b.scene.objects[0].id;
    }
    return b.scene;
}

// All corners show one object and one colour, but there is a gap between its parts.
TEST(CornersAndPatterns, AGapBetweenThePartsOfAnObjectIsDividedOrMarked) {
    for (const bool of_one_mesh : {true, false}) {
        const Scene scene = boards_with_gap(of_one_mesh);
        TraceSettings settings;
        settings.subdivision.levels = 4;
        const Image picture = TracedFrame(scene, settings).file().picture();
        // Each of the gap's two edges is known to half of 1/16 px.
        for (int y = 0; y < picture.height; ++y) EXPECT_NEAR(*picture.pixel(32, y), 0.6F * 0.5F, 0.5F / 16);
        settings.subdivision.levels = 0;
        const TracedFrame frame(scene, settings);
        EXPECT_TRUE(frame.file().header().has_marks);
        RecordBand band;
        frame.file().read(frame.file().y_begin(), frame.file().y_end(), band);
        for (const Record& r : band.records)
            EXPECT_EQ(r.mark, r.x == 32 || r.x == 33 ? RecordMark::gap : 0) << r.x << " " << r.y;
    }
}

// A strip in front of a wall, narrower than a pixel and between two corners, with a light on each side. Each
// corner is in the shadow of one light, and both have the same colour. The wall between them is lit by both
// lights.
TEST(CornersAndPatterns, ShadowsOfTwoLightsAreToldApart) {
    SceneBuilder b;
    const double px = 4 * 36 / 50.0 / 64, middle = px / 2;
    b.add(square({0, 0, -4}, {0, 0, 1}, 10), matte(dvec3(0.5)));
    const double above = 0.1;
    b.add(Rectangle{{middle - 0.2 * px, -1, -4 + above}, {0.4 * px, 0, 0}, {0, 2, 0}}, matte(dvec3(0)));
    for (const double side : {-1.0, 1.0}) {
        Light l;
        l.kind = Light::Kind::directional;
        l.direction = glm::normalize(dvec3(side * middle, 0, -above));
        b.scene.lights.push_back(l);
    }
    const RayScene rays(b.scene, 0);
    const CameraModel camera(b.scene.cameras[0], 0);
    const WhittedTracer tracer(rays, camera, {});
    TracedSamples two;
    RayCounts counts;
    const std::array<glm::dvec2, 3> at{glm::dvec2(32, 20), glm::dvec2(33, 20), glm::dvec2(36, 20)};
    tracer.trace(at, two, counts);
    ASSERT_EQ(two.records.size(), 3U);
    EXPECT_EQ(two.records[0].r, two.records[1].r);
    EXPECT_EQ(two.sources[0].shadows ^ two.sources[1].shadows, 3U);
    EXPECT_EQ(two.sources[2].shadows, 0U);
    bool divided = false;
    (void)sample_corners(tracer, {32, 33, 20, 21}, {.levels = 1}, [&](const RecordBand& band) {
        for (const Record& r : band.records) divided = divided || r.x == 32.5F;
    });
    EXPECT_TRUE(divided);
}

/// A wall at 10 m with round shadows of discs outside the frame, px: centre and radius.
Scene spotted_wall(const std::vector<glm::dvec3>& shadows) {
    SceneBuilder b;
    const double px = 10 * 36 / 50.0 / 64;
    const dvec3 light(0, 20, 0);
    b.add(square({0, 0, -10}, {0, 0, 1}, 20), matte(dvec3(0.5)));
    b.scene.lights.push_back({.kind = Light::Kind::point, .position = light});
    for (const dvec3& s : shadows) {
        const dvec3 on_wall((s.x - 32) * px, (24 - s.y) * px, -10);
        b.add(Disc{(light + on_wall) / 2.0, {0, 0, 1}, s.z * px / 2}, matte(dvec3(0.5)));
    }
    return b.scene;
}

// The four corners around the small shadow are lit. Its pixel is compared at its centre only beside a pixel
// that is divided, here by a larger shadow.
TEST(CornersAndPatterns, AShadowBetweenCornersIsFoundBesideAnEdge) {
    const dvec3 small(30.5, 20.5, 0.45), large(32.5, 20.5, 1);
    TraceSettings settings;
    settings.subdivision.levels = 4;
    const Image lit = TracedFrame(spotted_wall({}), settings).file().picture(),
                both = TracedFrame(spotted_wall({small, large}), settings).file().picture(),
                alone = TracedFrame(spotted_wall({small}), settings).file().picture();
    const auto darkened = [&](const Image& picture, int x, int y) {
        return 1 - *picture.pixel(x, y) / *lit.pixel(x, y);
    };
    // The material reflects ambient light as well, so no shadow is black. The outline of the small one
    // crosses 8 * 0.45 * 16 cells of 1/256 px^2. Each has a standard error of at most 0.3 times its area, and
    // their sum one of 0.009. Three of these are allowed.
    const double black = darkened(both, 32, 20);
    EXPECT_GT(black, 0.5);
    EXPECT_NEAR(darkened(both, 30, 20), black * std::numbers::pi * 0.45 * 0.45, 3 * 0.009);
    EXPECT_EQ(darkened(alone, 30, 20), 0);
    // What the centres show is not recorded.
    settings.subdivision.levels = 1;
    const TracedFrame coarse(spotted_wall({large}), settings);
    RecordBand band;
    coarse.file().read(coarse.file().y_begin(), coarse.file().y_end(), band);
    for (const Record& r : band.records) EXPECT_FALSE(r.x == 30.5F && r.y == 20.5F);
}

// Only the first of the small shadows lies beside a pixel that corners divide. The others continue it, as the
// shadow of a post does on the ground.
TEST(CornersAndPatterns, ShadowsBetweenCornersAreFollowedAlongTheRow) {
    const Scene row = spotted_wall(
        {{32.5, 20.5, 1}, {30.5, 20.5, 0.45}, {29.5, 20.5, 0.45}, {28.5, 20.5, 0.45}, {27.5, 20.5, 0.45}});
    TraceSettings settings;
    settings.subdivision.levels = 1;
    const TracedFrame frame(row, settings);
    const Image picture = frame.file().picture();
    // Only the centre of each pixel is in shadow. It belongs to a corner of each of four cells, so it counts
    // as a quarter of the pixel.
    const double lit = *picture.pixel(20, 20), black = 1 - *picture.pixel(32, 20) / lit;
    for (const int x : {27, 28, 29, 30}) EXPECT_NEAR(1 - *picture.pixel(x, 20) / lit, black / 4, 0.02) << x;
}

// A checkered floor whose cells become arbitrarily small towards the horizon. If only the corners' colours
// decided, the result would be 28 dB at any level. Four levels are 256 samples per pixel.
TEST(CornersAndPatterns, ACheckeredFloorIsKnownAsWellAsItIsDivided) {
    SceneBuilder b;
    Checker c;
    c.size = dvec3(0.15);
    c.offset = dvec3(0.0131, 0.0173, 0.0197);
    c.even = dvec3(0.9, 0.8, 0.6);
    c.odd = dvec3(0.1, 0.15, 0.2);
    Material floor = glowing(dvec3(1));
    floor.emission_texture = std::make_shared<const Texture>(c);
    b.add(Plane{{0, -0.7, 0}, {0, 1, 0}}, floor);
    RenderSettings truth;
    truth.spp = 1024;
    const Image reference = render_picture(b.scene, truth).image;
    const auto error_db = [&](int levels) {
        TraceSettings settings;
        settings.subdivision.levels = levels;
        return psnr(TracedFrame(b.scene, settings).file().picture(), reference);
    };
    const double two = error_db(2), four = error_db(4);
    // If every sample were random, the error would be 0.4 / 4 and 0.4 / 16.
    EXPECT_GT(two, 20);
    EXPECT_GT(four, 32);
    EXPECT_GT(four, two + 8);
}

}  // namespace
}  // namespace postlens::test::patterns_test
