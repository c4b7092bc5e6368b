// Common parts of scene readers: textures, transforms, polygons, boxes, words.
#include "scene/scene.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <tuple>

#include "core/error.h"
#include "core/text.h"
#include "scene/file_digest.h"
#include "scene/shape_bounds.h"
#include "scene/triangulate.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::scene_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double inf = std::numeric_limits<double>::infinity();

TEST(Checker, BordersBelongToTheHigherCell) {
    for (int k = -5; k <= 5; ++k) {
        // For sizes with exact multiples, tests the border itself and the neighbouring numbers.
        for (const double size : {0.125, 1.0, 3.0}) {
            const double border = k * size;
            EXPECT_EQ(checker_cell(border, 0, size), k) << k << " " << size;
            EXPECT_EQ(checker_cell(std::nextafter(border, inf), 0, size), k) << k << " " << size;
            EXPECT_EQ(checker_cell(std::nextafter(border, -inf), 0, size), k - 1) << k << " " << size;
            EXPECT_EQ(checker_cell(border + 0.25, 0.25, size), k) << k << " " << size;
            EXPECT_EQ(checker_cell(border - 0.5, -0.5, size), k) << k << " " << size;
        }
    }
}

TEST(Checker, CellIsTheFloorOfTheExactQuotient) {
    // The reference is c / size in 80-bit arithmetic, for cases in which the quotient in double rounds to an
    // integer.
    int rounded_up = 0;
    for (int n = 1; n < 20000; ++n) {
        const double size = 0.1 * (1 + n % 7);
        const double c = std::nextafter(n * size, n % 2 == 0 ? -inf : inf) * (n % 3 == 0 ? -1 : 1);
        const long double k = std::round(c / size);
        const long double rest = static_cast<long double>(c) - k * static_cast<long double>(size);
        const double expected = static_cast<double>(rest < 0 ? k - 1 : k);
        EXPECT_EQ(checker_cell(c, 0, size), expected) << c << " / " << size;
        rounded_up += std::floor(c / size) != expected ? 1 : 0;
    }
    EXPECT_GT(rounded_up, 100);  // plain floor(c / size) would have failed here
}

TEST(Checker, OffsetLosesNothingToRounding) {
    // c - offset rounds to 1 exactly, but c lies below the border at offset + 1.
    const double offset = -1e-17;
    EXPECT_EQ(checker_cell(1.0, 1e-17, 1.0), 0);
    EXPECT_EQ(checker_cell(1.0, offset, 1.0), 1);
}

TEST(Checker, ParityAndColoursInThreeDimensions) {
    Checker c;
    c.size = dvec3(0.5, 1, 2);
    c.even = dvec3(1, 0, 0);
    c.odd = dvec3(0, 0, 1);
    const Texture t(c);
    for (int x = -3; x <= 3; ++x) {
        for (int y = -3; y <= 3; ++y) {
            for (int z = -3; z <= 3; ++z) {
                const dvec3 centre = (dvec3(x, y, z) + 0.5) * c.size;
                const dvec3 corner = dvec3(x, y, z) * c.size;
                const dvec3 expected = (x + y + z) % 2 == 0 ? c.even : c.odd;
                EXPECT_EQ(t.colour(centre, {0, 0}), expected);
                EXPECT_EQ(t.colour(corner, {0, 0}), expected);
            }
        }
    }
    EXPECT_EQ(t.maximum(), 1);
}

TEST(Checker, TwoDimensionsUseUvOnly) {
    Checker c;
    c.dimensions = 2;
    c.size = dvec3(0.25, 0.5, 1);
    const Texture t(c);
    EXPECT_EQ(t.colour({7.7, 8.8, 9.9}, {0.1, 0.1}), c.even);
    EXPECT_EQ(t.colour({7.7, 8.8, 9.9}, {0.25, 0.1}), c.odd);
    EXPECT_EQ(t.colour({7.7, 8.8, 9.9}, {0.25, 0.5}), c.even);
    EXPECT_EQ(t.colour({7.7, 8.8, 9.9}, {-0.01, 0.1}), c.odd);
}

TEST(Checker, InfiniteSizeHasNoBorders) {
    Checker c;
    c.size = dvec3(1, inf, 1);
    const Texture t(c);
    for (const double y : {-1e9, -1e-300, 0.0, 1e-300, 1e9}) EXPECT_EQ(t.colour({0.5, y, 0.5}, {}), c.even);
}

ImageTexture four_texels() {
    ImageTexture image;
    image.width = 2;
    image.height = 2;
    image.rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};  // top: red, green; bottom: blue, white
    return image;
}

TEST(ImageTextures, NearestPicksTheTexelThatHoldsThePoint) {
    ImageTexture image = four_texels();
    image.nearest = true;
    const Texture t(image);
    EXPECT_EQ(t.colour({}, {0.2, 0.8}), dvec3(1, 0, 0));
    EXPECT_EQ(t.colour({}, {0.8, 0.8}), dvec3(0, 1, 0));
    EXPECT_EQ(t.colour({}, {0.2, 0.2}), dvec3(0, 0, 1));
    EXPECT_EQ(t.colour({}, {0.8, 0.2}), dvec3(1, 1, 1));
    EXPECT_EQ(t.colour({}, {0.5, 0.2}), dvec3(1, 1, 1));
    EXPECT_EQ(t.colour({}, {1.2, 0.2}), dvec3(0, 0, 1));   // u repeats
    EXPECT_EQ(t.colour({}, {-0.2, 0.2}), dvec3(1, 1, 1));  // u also repeats below 0
    EXPECT_EQ(t.colour({}, {0.2, 1.7}), dvec3(1, 0, 0));   // v is clamped
    EXPECT_EQ(t.colour({}, {0.2, -0.7}), dvec3(0, 0, 1));
}

TEST(ImageTextures, BilinearMeetsTexelCentresAndMeansBetween) {
    const Texture t(four_texels());
    EXPECT_EQ(t.colour({}, {0.25, 0.75}), dvec3(1, 0, 0));
    EXPECT_EQ(t.colour({}, {0.75, 0.25}), dvec3(1, 1, 1));
    EXPECT_EQ(t.colour({}, {0.5, 0.75}), dvec3(0.5, 0.5, 0));
    EXPECT_EQ(t.colour({}, {0.0, 0.75}), dvec3(0.5, 0.5, 0));  // across the seam in u
    EXPECT_EQ(t.colour({}, {1.0, 0.75}), dvec3(0.5, 0.5, 0));
    EXPECT_EQ(t.colour({}, {0.25, 1.0}), dvec3(1, 0, 0));  // the top row does not mix with the bottom one
    EXPECT_EQ(t.colour({}, {0.25, 0.0}), dvec3(0, 0, 1));
}

TEST(ImageTextures, RepeatTilesBothWays) {
    ImageTexture image = four_texels();
    image.nearest = true;
    image.repeat = dvec2(3, 2);
    const Texture t(image);
    EXPECT_EQ(t.colour({}, {0.1 / 3 + 1.0 / 3, 0.9 / 2}), dvec3(1, 0, 0));
    EXPECT_EQ(t.colour({}, {0.9 / 3 + 2.0 / 3, 0.1 / 2 + 0.5}), dvec3(1, 1, 1));
}

TEST(ImageTextures, NonFiniteUvStaysInside) {
    const Texture t(four_texels());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {nan, inf, -inf, 1e300, -1e300}) {
        const dvec3 c = t.colour({}, {bad, bad});
        EXPECT_TRUE(c.x >= 0 && c.x <= 1) << bad;
    }
}

std::vector<TransformKey> two_keys() {
    TransformKey a, b;
    a.time_s = 1;
    b.time_s = 3;
    b.translation = dvec3(4, 0, -2);
    b.rotation = glm::angleAxis(std::numbers::pi / 2, dvec3(0, 0, 1));
    b.scale = dvec3(3, 1, 1);
    return {a, b};
}

void expect_near(const dvec3& a, const dvec3& b, double tolerance = 1e-14) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

dvec3 moved(const std::vector<TransformKey>& keys, double time_s, const dvec3& p) {
    return dvec3(transform_at(keys, time_s) * glm::dvec4(p, 1));
}

TEST(TransformAt, NoKeysStandStill) {
    EXPECT_EQ(transform_at({}, 5), glm::dmat4(1));
}

TEST(TransformAt, MeetsItsKeysAndStopsAtTheEnds) {
    const auto keys = two_keys();
    EXPECT_EQ(transform_at(keys, 1), glm::dmat4(1));
    EXPECT_EQ(transform_at(keys, -7), glm::dmat4(1));
    EXPECT_EQ(transform_at(keys, 99), transform_at(keys, 3));
    expect_near(moved(keys, 3, {1, 0, 0}), {4, 3, -2});  // scaled, then rotated, then translated
}

TEST(TransformAt, MovesLinearlyAndTurnsEvenly) {
    const auto keys = two_keys();
    for (const double share : {0.1, 0.25, 0.5, 0.9}) {
        const double angle = share * std::numbers::pi / 2, scale = 1 + 2 * share;
        expect_near(moved(keys, 1 + 2 * share, {1, 0, 0}),
                    dvec3(4, 0, -2) * share + scale * dvec3(std::cos(angle), std::sin(angle), 0));
    }
}

TEST(TransformAt, TakesTheShortWayWhateverTheQuaternionsSign) {
    auto keys = two_keys();
    const dvec3 expected = moved(keys, 2, {1, 2, 3});
    keys[1].rotation = -keys[1].rotation;
    expect_near(moved(keys, 2, {1, 2, 3}), expected);
}

TEST(TransformAt, PicksTheRightPairOfManyKeys) {
    std::vector<TransformKey> keys(5);
    const std::array<double, 5> x{0, 1, 10, 100, 1000};
    for (std::size_t i = 0; i < keys.size(); ++i) {
        keys[i].time_s = static_cast<double>(i * i);
        keys[i].translation.x = x[i];
    }
    EXPECT_EQ(moved(keys, 0.5, {}).x, 0.5);
    EXPECT_EQ(moved(keys, 2.5, {}).x, 5.5);
    EXPECT_EQ(moved(keys, 4, {}).x, 10);
    EXPECT_EQ(moved(keys, 12.5, {}).x, 550);
}

double area_of(const std::vector<dvec3>& p, const Triangulation& cut, const dvec3& normal) {
    double area = 0;
    for (const glm::uvec3& t : cut.triangles) {
        const double a = 0.5 * glm::dot(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]), normal);
        EXPECT_GT(a, 0);  // every triangle has the polygon's winding
        area += a;
    }
    return area;
}

TEST(Triangulate, ConvexPolygonsBecomeFans) {
    const std::vector<dvec3> square{{0, 0, 5}, {2, 0, 5}, {2, 2, 5}, {0, 2, 5}};
    const Triangulation cut = triangulate(square);
    EXPECT_EQ(cut.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Triangulate, ConcavePolygonsKeepTheirArea) {
    // An L, a comb with teeth, and an arrow, each in a tilted plane far from the origin.
    const std::vector<std::vector<dvec2>> shapes{
        {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},
        {{0, 0},
         {7, 0},
         {7, 3},
         {6, 3},
         {6, 1},
         {5, 1},
         {5, 3},
         {4, 3},
         {4, 1},
         {3, 1},
         {3, 3},
         {2, 3},
         {2, 1},
         {1, 1},
         {1, 3},
         {0, 3}},
        {{0, 0}, {4, 2}, {0, 4}, {1, 2}},
    };
    const std::array<double, 3> areas{5, 15, 6};
    const dvec3 u = glm::normalize(dvec3(1, 2, -1)), v = glm::normalize(glm::cross(dvec3(0.3, -1, 2), u));
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        std::vector<dvec3> p;
        for (const dvec2& q : shapes[i]) p.push_back(dvec3(100, -200, 300) + q.x * u + q.y * v);
        const Triangulation cut = triangulate(p);
        EXPECT_EQ(cut.fault, PolygonFault::none);
        EXPECT_LE(cut.triangles.size(), p.size() - 2);  // corners that become collinear need no triangle
        EXPECT_NEAR(area_of(p, cut, glm::cross(u, v)), areas[i], 1e-9);
    }
}

TEST(Triangulate, StraightAndRepeatedCornersAreAllowed) {
    const std::vector<dvec3> p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}, {0, 2, 0}};
    const Triangulation cut = triangulate(p);
    EXPECT_EQ(cut.fault, PolygonFault::none);
    EXPECT_NEAR(area_of(p, cut, {0, 0, 1}), 3, 1e-12);
}

TEST(Triangulate, FaultsAreTold) {
    EXPECT_EQ(triangulate(std::vector<dvec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).fault, PolygonFault::no_area);
    EXPECT_EQ(triangulate(std::vector<dvec3>(4, dvec3(1))).fault, PolygonFault::no_area);
    // A five-pointed star drawn in one stroke.
    std::vector<dvec3> star;
    for (int i = 0; i < 5; ++i) {
        const double a = 2 * i * 2 * std::numbers::pi / 5;
        star.emplace_back(std::cos(a), std::sin(a), 0);
    }
    EXPECT_EQ(triangulate(std::vector<dvec3>{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}}).fault,
              PolygonFault::crosses_itself);
    EXPECT_EQ(triangulate(star).fault, PolygonFault::crosses_itself);
}

// Checks that all points of the surface lie in the box, and that points come close to all its sides.
void expect_tight(const Bounds& box, const std::vector<dvec3>& points, const glm::dmat4& m,
                  double tolerance) {
    Bounds seen;
    for (const dvec3& p : points) seen.add(dvec3(m * glm::dvec4(p, 1)));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(box.min[axis], seen.min[axis] + 1e-12);
        EXPECT_GE(box.max[axis], seen.max[axis] - 1e-12);
        EXPECT_NEAR(box.min[axis], seen.min[axis], tolerance);
        EXPECT_NEAR(box.max[axis], seen.max[axis], tolerance);
    }
}

TEST(ShapeBounds, AreTightUnderASkewedMap) {
    glm::dmat4 m = glm::mat4_cast(glm::angleAxis(0.7, glm::normalize(dvec3(1, 2, 3))));
    m[0] *= 2.0;
    m[1] += 0.4 * m[2];
    m[3] = glm::dvec4(5, -6, 7, 1);
    std::vector<dvec3> sphere, disc, cone;
    const dvec3 n = glm::normalize(dvec3(1, -1, 0.5)), u = glm::normalize(glm::cross(n, dvec3(0, 0, 1))),
                v = glm::cross(n, u);
    for (int i = 0; i < 720; ++i) {
        const double a = i * std::numbers::pi / 360;
        for (int j = 0; j <= 360; ++j) {
            const double b = j * std::numbers::pi / 360;
            sphere.push_back(dvec3(1, 2, 3) +
                             0.5 * dvec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)));
        }
        const dvec3 rim = std::cos(a) * u + std::sin(a) * v;
        disc.push_back(dvec3(1, 2, 3) + 0.5 * rim);
        cone.push_back(dvec3(1, 2, 3) + 0.5 * rim);
        cone.push_back(dvec3(1, 2, 3) + 2.0 * n + 0.25 * rim);
    }
    expect_tight(shape_bounds(Sphere{{1, 2, 3}, 0.5}, m), sphere, m, 1e-3);
    expect_tight(shape_bounds(Disc{{1, 2, 3}, 3.0 * n, 0.5, 0.1}, m), disc, m, 1e-3);
    expect_tight(shape_bounds(Cone{{1, 2, 3}, dvec3(1, 2, 3) + 2.0 * n, 0.5, 0.25, true}, m), cone, m, 1e-3);
    expect_tight(shape_bounds(Box{{0, 0, 0}, {1, 2, 3}}, m),
                 {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}, {0, 0, 3}, {1, 0, 3}, {0, 2, 3}, {1, 2, 3}}, m,
                 1e-12);
    expect_tight(shape_bounds(Rectangle{{0, 0, 1}, {1, 0, 0}, {0, 2, 0}}, m),
                 {{0, 0, 1}, {1, 0, 1}, {0, 2, 1}, {1, 2, 1}}, m, 1e-12);
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 4}};
    expect_tight(shape_bounds(std::shared_ptr<const Mesh>(mesh), m), {{0, 0, 0}, {1, 0, 0}, {0, 1, 4}}, m,
                 1e-12);
}

TEST(ShapeBounds, OfAPlaneAreInfinite) {
    const Bounds box = shape_bounds(Plane{}, glm::dmat4(1));
    EXPECT_EQ(box.min, dvec3(-inf));
    EXPECT_EQ(box.max, dvec3(inf));
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE(Bounds().empty());
}

TEST(Text, RoughNumbersHaveNoExponent) {
    EXPECT_EQ(rough(0), "0.000");
    EXPECT_EQ(rough(3e-5), "0.000");
    EXPECT_EQ(rough(0.00123), "0.0012");
    EXPECT_EQ(rough(0.125), "0.12");
    EXPECT_EQ(rough(9.96), "10");
    EXPECT_EQ(rough(99.4), "99");
    EXPECT_EQ(rough(99.6), "100");
    EXPECT_EQ(rough(123456.7), "123457");
}

TEST(ParseNumber, TakesDecimalsOnly) {
    EXPECT_EQ(parse_number("1.5e-3"), 1.5e-3);
    EXPECT_EQ(parse_number("+2"), 2);
    EXPECT_EQ(parse_number("-.5"), -0.5);
    EXPECT_EQ(parse_number("1e400"), inf);
    EXPECT_EQ(parse_number("1e-400"), 0);
    EXPECT_TRUE(std::isnan(*parse_number("nan")));
    for (const char* word : {"", "+", "-", "+-1", "1,5", "1.5x", "0x10", "1 2", "abc", "1e"}) {
        EXPECT_FALSE(parse_number(word)) << word;
    }
}

TEST(NearestWord, CountsEditsAndSwaps) {
    constexpr std::array<std::string_view, 4> words{"radius_m", "centre_m", "material", "normal"};
    EXPECT_EQ(nearest_word("raduis_m", words), "radius_m");
    EXPECT_EQ(nearest_word("center_m", words), "centre_m");
    EXPECT_EQ(nearest_word("materail", words), "material");
    EXPECT_EQ(nearest_word("norm", words), "normal");
    EXPECT_EQ(nearest_word("x", {}), "");
    EXPECT_EQ(nearest_word("norm", words, 2), "normal");
    EXPECT_EQ(nearest_word("crop", words, 2), "");
}

TEST(Excerpt, IsShortAndPrintable) {
    EXPECT_EQ(excerpt("abc"), "'abc'");
    EXPECT_EQ(excerpt("a\nb\x1b[31m"), "'a?b?[31m'");
    EXPECT_EQ(excerpt(std::string(100, 'x')).size(), 45U);
    // U+009B begins a command of a terminal as well. Other characters of two bytes stay, and so does a byte
    // C2 that is not UTF-8.
    EXPECT_EQ(printable_lines("a\x1b[31m\n\xC2\x9B"
                              "31m\t\x7F \xC2\xB5\xC2 "),
              "a?[31m\n?31m?? \xC2\xB5\xC2 ");
    EXPECT_EQ(printable("a\nb\r"), "a?b?");
}

TEST(FileDigest, IsSha256) {
    Sha256 empty;
    EXPECT_EQ(empty.hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    Sha256 abc;  // the example of FIPS 180-2
    abc.add("a");
    abc.add("bc");
    EXPECT_EQ(abc.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

std::string error_of(const std::filesystem::path& path, const SceneReadOptions& options, ExitCode code) {
    try {
        std::ignore = read_scene(path, options);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        return error.what();
    }
    return "no error";
}

TEST(ReadScene, RefusesWhatIsNoFile) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path() / "folder.toml");
    std::filesystem::create_directory(folder.path() / "folder.nff");
    const auto code = ExitCode::invalid_input;
    for (const char* ending : {"toml", "nff"}) {
        const auto missing = folder.path() / (std::string("missing.") + ending);
        EXPECT_EQ(error_of(missing, {}, code), missing.string() + ": cannot read (no such file)");
        const auto inside = folder.path() / (std::string("folder.") + ending);
        EXPECT_EQ(error_of(inside, {}, code),
                  inside.string() + ": cannot read (got a folder; expected a file)");
    }
    EXPECT_EQ(
        error_of("picture.exr", {}, code),
        "picture.exr: not a scene by its ending (got '.exr'; expected .toml, .nff, .gltf, .glb, .obj, .ply)");
    EXPECT_EQ(error_of("scene", {}, code),
              "scene: not a scene by its ending (got ''; expected .toml, .nff, .gltf, .glb, .obj, .ply)");
}

TEST(ReadScene, RefusesUnitsOutOfRange) {
    const std::string sample = std::string(POSTLENS_SAMPLES) + "/scenes/bars.toml";
    for (const double bad : {0.0, -1.0, inf, std::numeric_limits<double>::quiet_NaN(), 1e-300}) {
        EXPECT_EQ(error_of(sample, {.metres_per_unit = bad}, ExitCode::wrong_arguments)
                      .rfind("--metres-per-unit: out of range (got ", 0),
                  0U)
            << bad;
    }
}

}  // namespace
}  // namespace postlens::test::scene_test
