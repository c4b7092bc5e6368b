// The camera with a lens: fast rays against simple ones, and the properties of a thin lens.
#include "tracer/distributed/lens_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "records/sample_file.h"
#include "tests/support/random_motion.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/exposure.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::lens_camera_test {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double float_rounding = 0x1p-24;

struct View {
    Camera camera;
    double f_number = infinity, focal_length_mm = 50, focus_m = infinity;
    Framing framing = Framing::keep;
    TimeSpan span{0, 1};
    ShutterCurve curve = ShutterCurve::box();

    [[nodiscard]] CameraModel model() const { return {camera, span.open_s}; }
    [[nodiscard]] FocusGeometry geometry() const {
        const CameraModel m = model();
        if (m.projection == Camera::Projection::orthographic) return {};
        return focus_geometry({focal_length_mm, f_number}, focus_m, framing,
                              {m.film_distance_mm, m.pixel_pitch_mm});
    }
    [[nodiscard]] LensCamera lens() const { return {camera, model(), {geometry(), span, curve}}; }
};

View view(RandomNumbers& random) {
    View v;
    v.camera.focal_length_mm = 35;
    v.camera.width = 64;
    v.camera.height = 48;
    v.camera.position = random.in_box(3);
    v.camera.look_at = v.camera.position + random.direction();
    v.camera.up = random.direction();
    return v;
}

std::vector<TransformKey> rigid_keys(RandomNumbers& random, const std::vector<double>& times) {
    return random_keys(random, times, {1, 1, 1, 1});
}

// Tolerances of float rays. A tangent is the product of px <= 32 and pitch / d, with three roundings; the
// lens part also has sines and cosines whose series have an error of 4e-7 of the radius. Three sums of three
// products and the normalisation follow: below 12 roundings of numbers below 2 (half of the film width over d
// is 18 / 35). With the focus at s, the error of the lens part is divided by s. Origins have the rounding of
// the position and of the lens point.
void expect_same_rays(const View& v, RandomNumbers& random, bool with_times) {
    const LensCamera camera = v.lens();
    const double aperture_m = v.geometry().aperture_radius_m;
    const double lens_error_m = (4e-7 + 4 * float_rounding) * aperture_m;
    const double direction_error = 24 * float_rounding + lens_error_m * v.geometry().inverse_focus_per_m;
    for (int group = 0; group < 8; ++group) {
        LensSamples s{};
        for (std::size_t i = 0; i < 16; ++i) {
            s.x[i] = static_cast<float>(random.in(0, v.camera.width));
            s.y[i] = static_cast<float>(random.in(0, v.camera.height));
            s.lens_u[i] = static_cast<float>(random.in(0, 0.9999999));
            s.lens_v[i] = static_cast<float>(random.in(0, 0.9999999));
            s.time[i] = static_cast<float>(random.in(0, 0.9999999));
            if (group == 0)
                s.lens_u[i] =
                    i % 2 == 0 ? 0.5F : static_cast<float>(i) / 16;  // centre and diagonal of the lens
            if (group == 0) s.lens_v[i] = s.lens_u[i];
        }
        RayBatch batch;
        batch.clear(false, with_times);
        std::vector<float> weights;
        camera.add_rays(s, batch, weights);
        EXPECT_TRUE(weights.empty());
        ASSERT_EQ(batch.count, 16);
        for (std::size_t i = 0; i < 16; ++i) {
            const LensCamera::Ray r = camera.ray(
                static_cast<double>(s.x[i]), static_cast<double>(s.y[i]), static_cast<double>(s.lens_u[i]),
                static_cast<double>(s.lens_v[i]), static_cast<double>(s.time[i]));
            const dvec3 o(glm::vec3(batch.ox[i], batch.oy[i], batch.oz[i]));
            const dvec3 d(glm::vec3(batch.dx[i], batch.dy[i], batch.dz[i]));
            const double far = std::max({std::abs(r.origin.x), std::abs(r.origin.y), std::abs(r.origin.z)});
            EXPECT_LE(glm::length(o - r.origin), lens_error_m + 8 * float_rounding * (far + aperture_m + 1));
            EXPECT_LE(glm::length(d - r.direction), direction_error);
            EXPECT_NEAR(glm::length(d), 1, 4 * float_rounding);
            EXPECT_EQ(batch.t_far[i], std::numeric_limits<float>::infinity());
            if (!with_times) continue;
            EXPECT_NEAR(static_cast<double>(batch.time[i]), r.time, float_rounding);
        }
    }
}

TEST(LensCameras, FastRaysAreTheObviousOnes) {
    RandomNumbers random(11);
    for (int i = 0; i < 24; ++i) {
        View v = view(random);
        if (i % 2 == 1) v.f_number = 0.7;
        if (i % 4 == 3) v.focus_m = 0.8;
        if (i % 3 == 1) v.curve = ShutterCurve::triangle();
        if (i % 3 == 2) v.camera.keys = rigid_keys(random, {0.1, 0.6, 0.9});
        expect_same_rays(v, random, i % 5 < 3);
    }
}

TEST(LensCameras, FastRaysOfParallelProjectionToo) {
    RandomNumbers random(12);
    for (int i = 0; i < 6; ++i) {
        View v = view(random);
        v.camera.projection = Camera::Projection::orthographic;
        v.camera.orthographic_width_m = 2;
        if (i % 2 == 1) v.camera.keys = rigid_keys(random, {0, 1});
        expect_same_rays(v, random, i % 3 == 0);
    }
}

// Without lens and shutter the rays equal those of `trace`. The pitch of the orthographic camera is a float,
// with an error of 2^-24 over half of its width of 2 m.
TEST(LensCameras, APinholeOfAnInstantIsTheCameraModel) {
    RandomNumbers random(13);
    for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
        View v = view(random);
        v.camera.projection = projection;
        v.camera.orthographic_width_m = 2;
        v.camera.keys = rigid_keys(random, {0, 2});
        v.span = {0.7, 0.7};
        const LensCamera camera = v.lens();
        EXPECT_FALSE(camera.moves());
        for (int i = 0; i < 100; ++i) {
            const double x = random.in(-5, 70), y = random.in(-5, 60);
            const LensCamera::Ray a = camera.ray(x, y, random.in(0, 1), random.in(0, 1), random.in(0, 1));
            const CameraRay b = v.model().ray(x, y);
            const double tolerance =
                projection == Camera::Projection::perspective ? 1e-14 : 2 * float_rounding;
            EXPECT_LE(glm::length(a.origin - b.origin), 2 * tolerance);
            EXPECT_LE(glm::length(a.direction - b.direction), 1e-14);
        }
    }
}

TEST(LensCameras, RaysOfOnePointMeetInTheFocalPlane) {
    RandomNumbers random(14);
    for (const double focus_m : {0.03, 0.5, 7.0, infinity}) {
        View v = view(random);
        v.f_number = 1;
        v.focus_m = focus_m;
        const LensCamera camera = v.lens();
        const CameraModel m = v.model();
        for (int i = 0; i < 20; ++i) {
            const double x = random.in(0, 64), y = random.in(0, 48);
            const CameraRay pinhole = m.ray(x, y);
            for (int k = 0; k < 20; ++k) {
                const LensCamera::Ray r = camera.ray(x, y, random.in(0, 1), random.in(0, 1), 0.5);
                // The origin lies in the plane of the lens and within its aperture.
                const dvec3 q = r.origin - m.position;
                EXPECT_NEAR(glm::dot(q, m.forward), 0, 1e-14);
                EXPECT_LE(glm::length(q), 0.025 * (1 + 1e-12));
                if (focus_m == infinity) {
                    EXPECT_LE(glm::length(r.direction - pinhole.direction), 1e-14);
                    continue;
                }
                const auto at_focus = [&](const dvec3& o, const dvec3& d) {
                    return o + d * (focus_m / glm::dot(d, m.forward));
                };
                // Roundings of 2^-53 for positions of a few metres and a distance of focus_m.
                EXPECT_LE(
                    glm::length(at_focus(r.origin, r.direction) - at_focus(m.position, pinhole.direction)),
                    1e-14 * (5 + focus_m));
            }
        }
    }
}

// Tests FocusGeometry by rays: a point at z' moves on the raster by gain (1/s - 1/z') q.
TEST(LensCameras, APointOutOfFocusMovesAsTheGeometrySays) {
    RandomNumbers random(15);
    for (const Framing framing : {Framing::keep, Framing::lens, Framing::breathing}) {
        View v = view(random);
        v.f_number = 2;
        v.focal_length_mm = 80;
        v.focus_m = 1.5;
        v.framing = framing;
        const CameraModel m = v.model();
        // The film distances of the three framings: d, F and V = F s / (s - F).
        const double film_mm = framing == Framing::keep   ? 35
                               : framing == Framing::lens ? 80
                                                          : 80 * 1500.0 / (1500 - 80);
        const double gain = film_mm / m.pixel_pitch_mm;
        EXPECT_NEAR(v.geometry().gain_px, gain, 1e-11);
        const LensCamera camera = v.lens();
        for (int i = 0; i < 200; ++i) {
            const double x = random.in(0, 64), y = random.in(0, 48), depth = random.in(0.3, 9);
            const LensCamera::Ray r = camera.ray(x, y, random.in(0, 1), random.in(0, 1), 0.5);
            const dvec3 p = r.origin + r.direction * (depth / glm::dot(r.direction, m.forward)) - m.position;
            const dvec3 q = r.origin - m.position;
            const dvec2 seen(32 + gain * glm::dot(p, m.right) / depth,
                             24 + gain * glm::dot(p, m.down) / depth);
            const dvec2 lens(glm::dot(q, m.right), glm::dot(q, m.down));
            // The lens's centre sees the point at `seen`, lens point q at (x, y).
            const dvec2 moved = gain * (1 / v.focus_m - 1 / depth) * lens;
            EXPECT_NEAR(seen.x + moved.x, x, 1e-10);
            EXPECT_NEAR(seen.y + moved.y, y, 1e-10);
        }
    }
}

TEST(DiscPoints, AreSpreadEvenly) {
    // A chi-square test with 256 cells, in 16 rings of equal area and 16 sectors. The statistic has mean 255
    // and standard deviation sqrt(2 * 255).
    constexpr int rings = 16, sectors = 16, cells = rings * sectors, n = 1 << 16;
    std::vector<int> count(cells, 0);
    RandomNumbers random(16);
    for (int i = 0; i < n; ++i) {
        const dvec2 p = disc_point(random.in(0, 1), random.in(0, 1));
        const double area = glm::dot(p, p), turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
        ASSERT_LE(area, 1 + 1e-15);
        const int ring = std::min(static_cast<int>(area * rings), rings - 1);
        ++count[static_cast<std::size_t>(ring * sectors +
                                         std::min(static_cast<int>(turn * sectors), sectors - 1))];
    }
    const double expected = static_cast<double>(n) / cells;
    double statistic = 0;
    for (const int c : count) statistic += (c - expected) * (c - expected) / expected;
    EXPECT_LE(statistic, cells - 1 + 4 * std::sqrt(2.0 * (cells - 1)));
    EXPECT_GE(statistic, cells - 1 - 4 * std::sqrt(2.0 * (cells - 1)));
}

TEST(DiscPoints, NeighboursStayNeighbours) {
    RandomNumbers random(17);
    double most = 0;
    for (int i = 0; i < 100000; ++i) {
        const double u = random.in(0, 1), v = random.in(0, 1), angle = random.in(0, 7);
        constexpr double step = 1e-4;
        const dvec2 a = disc_point(u, v),
                    b = disc_point(u + step * std::cos(angle), v + step * std::sin(angle));
        most = std::max(most, glm::length(a - b) / step);
    }
    // The map is (r, phi) = (a, (pi/4) b/a) with a = 2u - 1, b = 2v - 1. The columns of its derivative in the
    // directions of r and phi are 2 (1, -(pi/4) b/a) and 2 (0, pi/4), with a Frobenius norm below
    // 2 sqrt(1 + 2 (pi/4)^2) = 2.99. This also holds across the seams, where the map is continuous.
    EXPECT_LE(most, 2.99);
    EXPECT_EQ(disc_point(0.5, 0.5), dvec2(0));
    EXPECT_NEAR(disc_point(1, 0.5).x, 1, 1e-15);
    EXPECT_NEAR(disc_point(0.5, 0).y, -1, 1e-15);
    EXPECT_NEAR(glm::length(disc_point(1, 1)), 1, 1e-15);
}

TEST(LensCameras, ScaleIsWhatASmallMoveIsWorth) {
    RandomNumbers random(18);
    View v = view(random);
    v.camera.keys = rigid_keys(random, {0, 1});
    const LensCamera camera = v.lens();
    for (int i = 0; i < 50; ++i) {
        const double t = random.in(0, 1);
        const CameraModel m(v.camera, t);
        const double depth = random.in(0.5, 20);
        const dvec3 p = m.position + m.ray(random.in(0, 64), random.in(0, 48)).direction * depth;
        const auto raster_x = [&](const dvec3& world) {
            const dvec3 from = world - m.position;
            return glm::dot(from, m.right) / glm::dot(from, m.forward) / m.tangent_per_px;
        };
        // At constant depth the raster is a linear function of position, so the difference is only rounding.
        const double px = raster_x(p + m.right) - raster_x(p);
        EXPECT_NEAR(camera.px_per_m(p, t), px, 1e-9 * px);
        EXPECT_EQ(camera.px_per_m(m.position - m.forward * depth, t), 0);
    }
}

// A scene with all kinds of content that has a position: shapes, meshes, motion, lights, a lens.
SceneBuilder placed_scene(const dvec3& origin) {
    SceneBuilder b;
    const auto at = [&](const dvec3& p) { return glm::translate(glm::dmat4(1), origin + p); };
    Material shiny = matte({0.3, 0.5, 0.4});
    shiny.reflection = dvec3(0.4);
    b.add(Sphere{{0, 0, 0}, 0.5}, shiny, at({-0.5, 0, -3}));
    b.add(Box{{-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}}, matte({0.7, 0.2, 0.2}), at({0.75, 0, -2.5}));
    b.add(sphere_mesh(6, 8, true), matte({0.2, 0.2, 0.9}), at({0, 1, -4}));
    b.add(Plane{{0, 0, 0}, {0, 1, 0}}, matte(dvec3(0.6)), at({0, -0.5, 0}));
    b.add(sphere_mesh(4, 6, false), matte({0.9, 0.8, 0.2}));
    b.add(Sphere{{0, 0, 0}, 0.25}, glowing({0.5, 0.2, 0.7}));
    for (Object* o : {&b.scene.objects[b.scene.objects.size() - 2], &b.scene.objects.back()}) {
        o->keys.resize(2);
        o->keys[0].translation = origin + dvec3(-1, 0.5, -3.5);
        o->keys[1].translation = origin + dvec3(1, 0.25, -4);
        o->keys[1].time_s = 1;
        o->keys[1].rotation = glm::angleAxis(0.5, dvec3(0, 0, 1));
    }
    Light& lamp = b.point_light(origin + dvec3(2, 3, 0), dvec3(0.8));
    lamp.kind = Light::Kind::sphere;
    lamp.radius = 0.5;
    Light& going = b.point_light(dvec3(0), dvec3(0.3));
    going.keys.resize(2);
    going.keys[0].translation = origin + dvec3(-3, 2, 1);
    going.keys[1].translation = origin + dvec3(-2, 2, 1);
    going.keys[1].time_s = 1;
    Camera& c = b.scene.cameras[0];
    c.width = 32;
    c.height = 24;
    c.position = origin + dvec3(0.125, 0.25, 1);
    c.look_at = c.position + dvec3(0, -0.125, -1);
    return b;
}

RenderSettings lens_and_shutter() {
    RenderSettings s;
    s.f_number = 1;
    s.focus_m = 3.5;
    s.shutter = TimeSpan{0.25, 0.75};
    s.spp = 8;
    return s;
}

// All positions and the offset are multiples of 1/8, so sums and differences are exact, and the recentred
// scenes are bit-identical.
TEST(FarFromTheOrigin, ThePictureIsTheSame) {
    const Image near = render_picture(placed_scene(dvec3(0)).scene, lens_and_shutter()).image;
    const Image far = render_picture(placed_scene({1e6, -2e6, 5e5}).scene, lens_and_shutter()).image;
    EXPECT_EQ(near.rgb, far.rgb);
    float brightest = 0, darkest = 1;
    for (const float v : near.rgb) brightest = std::max(brightest, v), darkest = std::min(darkest, v);
    EXPECT_GT(brightest, 0.5F);
    EXPECT_LT(darkest, 0.1F);
    // The keys of a moving camera are translated as well.
    std::array<Image, 2> moving;
    for (std::size_t i = 0; i < 2; ++i) {
        const dvec3 origin = i == 0 ? dvec3(0) : dvec3(1e6, -2e6, 5e5);
        SceneBuilder b = placed_scene(origin);
        Camera& c = b.scene.cameras[0];
        c.position = dvec3(0);
        c.look_at = dvec3(0, 0, -1);
        c.keys.resize(2);
        c.keys[0].translation = origin + dvec3(0.125, 0.25, 1);
        c.keys[1].translation = origin + dvec3(0.375, 0.25, 1);
        c.keys[1].time_s = 1;
        moving[i] = render_picture(b.scene, lens_and_shutter()).image;
    }
    // The camera has moved by 1/8 of its path when the shutter opens, which is also exact.
    EXPECT_EQ(moving[0].rgb, moving[1].rgb);
    EXPECT_NE(moving[0].rgb, near.rgb);
}

TEST(FarFromTheOrigin, TheRecordsAreTheSame) {
    const TemporaryFolder folder;
    TraceSettings settings;
    settings.subdivision.levels = 1;
    settings.time_s = 0.25;
    settings.for_f_number = 1;
    settings.for_focus_m = 3.5;
    settings.for_shutter = TimeSpan{0.25, 0.75};
    settings.keys = 2;
    std::array<std::array<RecordBand, 2>, 2> records;
    std::array<double, 2> stops{};
    for (std::size_t i = 0; i < 2; ++i) {
        const dvec3 origin = i == 0 ? dvec3(0) : dvec3(1e6, -2e6, 5e5);
        const Scene scene = placed_scene(origin).scene;
        trace_to_file(scene, settings, folder.path() / "far.exr");
        const SampleFileReader file(folder.path() / "far.exr");
        for (std::size_t key = 0; key < 2; ++key) file.read(0, 24, records[i][key], key);
        EXPECT_EQ(dvec3(file.header().world_from_camera[3]), origin + dvec3(0.125, 0.25, 1));
        stops[i] = auto_exposure_stops(scene, "", {});
    }
    for (std::size_t key = 0; key < 2; ++key) {
        EXPECT_EQ(records[0][key].offsets, records[1][key].offsets);
        EXPECT_TRUE(records[0][key].records == records[1][key].records);
    }
    EXPECT_FALSE(records[0][0].records == records[0][1].records);
    EXPECT_EQ(stops[0], stops[1]);
}

}  // namespace
}  // namespace postlens::test::lens_camera_test
