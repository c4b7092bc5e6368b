// Corner sampling: each point is sampled once, subdivision where required, the published ray counts of the
// Standard Procedural Databases, and equal files for any number of threads.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/threads.h"
#include "records/quadtree.h"
#include "records/sample_file.h"
#include "tests/support/file_bytes.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/trace.h"

namespace postlens::test::sampling_test {
namespace {

namespace fs = std::filesystem;

// A scene with mirrors, glass, edges in all directions, a thin object and a light.
SceneBuilder busy_scene() {
    SceneBuilder b;
    Material m = matte({0.6, 0.5, 0.4});
    m.reflection = glm::dvec3(0.3);
    b.add(Sphere{{-0.4, 0, -4}, 0.6}, m);
    Material g = glass(1.5, 0.9);
    g.reflection = glm::dvec3(0.1);
    b.add(Sphere{{0.6, 0.1, -3.5}, 0.4}, g);
    b.add(Plane{{0, -0.6, 0}, {0, 1, 0}}, matte({0.3, 0.6, 0.3}));
    b.add(Cone{{0.1, -0.6, -3}, {0.1, 0.8, -3}, 0.004, 0.004}, glowing({5, 4, 3}));
    b.add(square({0, 0, -9}, {0, 0, 1}, 12), matte({0.2, 0.2, 0.7}));
    b.point_light({2, 3, 0}, glm::dvec3(1));
    b.scene.ambient_light = glm::dvec3(0.2);
    return b;
}

struct Sampled {
    RecordBand all;
    RayCounts counts;
    std::vector<RecordBand> bands;
};
Sampled sample(const Scene& scene, const SampledWindow& window, const SubdivisionSettings& settings) {
    const RayScene rays(scene, 0);
    const CameraModel camera(scene.cameras[0], 0);
    const WhittedTracer tracer(rays, camera, {});
    Sampled out;
    out.all.x_begin = window.x_begin;
    out.all.x_end = window.x_end + 1;
    out.all.y_begin = out.all.y_end = window.y_begin;
    out.counts = sample_corners(tracer, window, settings, [&](const RecordBand& band) {
        EXPECT_EQ(band.y_begin, out.all.y_end);
        const auto before = static_cast<std::uint32_t>(out.all.records.size());
        for (std::size_t i = 1; i < band.offsets.size(); ++i)
            out.all.offsets.push_back(before + band.offsets[i]);
        out.all.records.insert(out.all.records.end(), band.records.begin(), band.records.end());
        out.all.y_end = band.y_end;
        out.bands.push_back(band);
    });
    return out;
}

TEST(CornerSampler, WithoutSubdivisionOneSamplePerCorner) {
    const SceneBuilder b = busy_scene();
    const Sampled s = sample(b.scene, {-2, 66, -3, 51}, {.levels = 0});
    EXPECT_EQ(s.counts.eye, 69U * 55U);
    EXPECT_EQ(s.all.y_end, 52);
    std::set<std::pair<float, float>> seen;
    for (const Record& r : s.all.records) {
        if (r.path.bits() == 0) {
            EXPECT_TRUE(seen.emplace(r.x, r.y).second);
        }
    }
    EXPECT_EQ(seen.size(), s.counts.eye);
}

TEST(CornerSampler, EachPointOnceAndIdsSplitToTheLastLevel) {
    SceneBuilder b = busy_scene();
    b.scene.cameras[0].height = 200;  // makes several bands
    for (const int levels : {1, 3, 5}) {
        const Sampled s = sample(b.scene, {0, 64, 0, 200}, {.levels = levels, .threshold = 0.2});
        std::map<std::pair<float, float>, std::uint32_t> id;  // y, x
        std::uint64_t primaries = 0;
        for (const Record& r : s.all.records) {
            if (r.path.bits() != 0) continue;
            ++primaries;
            id[{r.y, r.x}] = r.id;
        }
        EXPECT_EQ(primaries, id.size());
        // Only the centres of pixels beside divided ones are traced and not recorded.
        const auto is_divided = [&](int x, int y) {
            return id.contains({static_cast<float>(y) + 0.5F, static_cast<float>(x) + 0.5F});
        };
        std::uint64_t beside = 0;
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 64; ++x) beside += is_divided(x - 1, y) || is_divided(x + 1, y) ? 1 : 0;
        }
        EXPECT_GT(s.counts.eye, primaries);
        EXPECT_LE(s.counts.eye, primaries + beside);
        EXPECT_GT(s.bands.size(), 2U);
        // Walks the quadtree as a reader does: no leaf above the last level has corners of different ids, and
        // no corner is missing.
        const std::function<void(double, double, double)> visit = [&](double x, double y, double size) {
            const auto at = [&](double dx, double dy) {
                const auto found = id.find({static_cast<float>(y + dy), static_cast<float>(x + dx)});
                EXPECT_NE(found, id.end()) << x + dx << "," << y + dy;
                return found == id.end() ? 0U : found->second;
            };
            const std::uint32_t a = at(0, 0), c = at(size, 0), d = at(0, size), e = at(size, size);
            const double half = size / 2;
            if (id.contains({static_cast<float>(y + half), static_cast<float>(x + half)})) {
                visit(x, y, half), visit(x + half, y, half), visit(x, y + half, half),
                    visit(x + half, y + half, half);
            } else if (size > std::exp2(-levels)) {
                EXPECT_TRUE(a == c && a == d && a == e) << x << "," << y;
            }
        };
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 64; ++x) visit(x, y, 1);
        }
    }
}

TEST(CornerSampler, SubdivisionConvergesToTheAreaOfAThinThing) {
    // An emitting strip of 0.23 px width: corners alone miss it or make it far too wide.
    SceneBuilder b;
    const double pitch = 36.0 / 64 / 50;  // tangent of a pixel
    const double z = 2, left = (10.4 - 32) * pitch * z, width = 0.23 * pitch * z;
    b.add(Rectangle{{left, -1, -z}, {width, 0, 0}, {0, 2, 0}}, glowing(glm::dvec3(1)));
    b.add(square({0, 0, -8}, {0, 0, 1}, 30), glowing(glm::dvec3(0)));
    const Sampled s = sample(b.scene, {0, 64, 0, 8}, {.levels = 8});
    // The corners at x = 10 and 11 both miss the strip, so it is not found.
    std::vector<float> row(3);
    picture_row(s.all, 3, 10, 11, row);
    EXPECT_EQ(row[0], 0);
    // After it is moved so that a corner hits it, its width is found to 1/256 px on each side.
    b.scene.objects[0].shape = Rectangle{{left - 0.5 * pitch * z, -1, -z}, {width, 0, 0}, {0, 2, 0}};
    const Sampled seen = sample(b.scene, {0, 64, 0, 8}, {.levels = 8});
    std::vector<float> both(6);
    picture_row(seen.all, 3, 9, 11, both);
    EXPECT_NEAR(both[0] + both[3], 0.23, 1.0 / 128);
}

TEST(CornerSampler, BandsDoNotShow) {
    // Rows have the same records whether the window begins above them or at them.
    SceneBuilder b = busy_scene();
    b.scene.cameras[0].height = 200;
    const Sampled whole = sample(b.scene, {0, 64, 0, 200}, {.levels = 3});
    const Sampled part = sample(b.scene, {0, 64, 37, 150}, {.levels = 3});
    std::vector<float> a(64 * 3), c(64 * 3);
    for (int y = 37; y < 150; ++y) {
        picture_row(whole.all, y, 0, 64, a);
        picture_row(part.all, y, 0, 64, c);
        ASSERT_EQ(a, c) << "row " << y;
    }
}

TEST(Trace, TheSameFileForAnyNumberOfThreads) {
    SceneBuilder b = busy_scene();
    const TemporaryFolder folder;
    std::vector<std::string> files;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const fs::path path = folder.path() / (std::to_string(threads) + ".exr");
        trace_to_file(
            b.scene,
            {.camera = {.width = 160, .height = 120}, .subdivision = {.levels = 3}, .overscan_px = 5}, path);
        files.push_back(bytes_of(path));
    }
    EXPECT_FALSE(files[0].empty());
    EXPECT_EQ(files[0], files[1]);
}

TEST(Trace, PartZeroIsThePictureOfTheRecords) {
    SceneBuilder b = busy_scene();
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "busy.exr";
    const TraceResult traced = trace_to_file(b.scene, {.subdivision = {.levels = 4}, .overscan_px = 3}, path);
    const SampleFileReader file(path);
    EXPECT_EQ(file.record_count(), traced.records);
    EXPECT_TRUE(file.header().has_w);
    const Image stored = file.picture();
    RecordBand band;
    for (int y = 0; y < file.header().height; ++y) {
        file.read(y, y + 2, band);
        std::vector<float> row(static_cast<std::size_t>(file.header().width) * 3);
        picture_row(band, y, 0, file.header().width, row);
        ASSERT_EQ(std::vector<float>(stored.pixel(0, y), stored.pixel(0, y) + row.size()), row)
            << "row " << y;
    }
}

TEST(Trace, OverscanAutoReachesAsFarAsNearThingsBlur) {
    SceneBuilder b;
    b.add(square({0, 0, -10}, {0, 0, 1}, 60), glowing(glm::dvec3(1)));
    const TemporaryFolder folder;
    TraceSettings t{.camera = {.width = 320, .height = 240},
                    .overscan_auto = true,
                    .for_f_number = 1.4,
                    .for_focus_m = 10};
    EXPECT_LE(trace_to_file(b.scene, t, folder.path() / "a.exr").overscan_px,
              16);                                             // one or two steps of the coarse trace
    b.add(Sphere{{0.9, 0, -2}, 0.3}, glowing(glm::dvec3(2)));  // at 2 m, just outside of the right border
    const int near = trace_to_file(b.scene, t, folder.path() / "b.exr").overscan_px;
    const double coc_radius_px = 0.5 * 50 / (36.0 / 320) * (0.05 / 1.4) * (1 / 2.0 - 1 / 10.0);
    EXPECT_GE(near, coc_radius_px / 4);
    EXPECT_LE(near, coc_radius_px + 24);
}

TEST(Trace, RefusesWhatIsOutOfRange) {
    SceneBuilder b = busy_scene();
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "x.exr";
    const auto code = [&](const TraceSettings& s) {
        try {
            trace_to_file(b.scene, s, path);
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.code();
        }
        return ExitCode::ok;
    };
    EXPECT_EQ(code({.subdivision = {.levels = -1}}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.subdivision = {.levels = 9}}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.subdivision = {.threshold = std::nan("")}}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.whitted = {.max_depth = 0}}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.whitted = {.min_contribution = -1}}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.overscan_px = -1}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.overscan_auto = true}), ExitCode::wrong_arguments);
    EXPECT_EQ(code({.camera_name = "nobody"}), ExitCode::wrong_arguments);
    b.scene.cameras[0].projection = Camera::Projection::orthographic;
    EXPECT_EQ(code({.overscan_auto = true, .for_f_number = 2, .for_focus_m = 1}), ExitCode::wrong_arguments);
    EXPECT_FALSE(fs::exists(path));
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

// The published settings of the Standard Procedural Databases: 513 x 513 corner rays, depth 5.
class PublishedRayCounts : public testing::TestWithParam<std::string> {};

TEST_P(PublishedRayCounts, AreMet) {
    const fs::path data = POSTLENS_SHARED_DATA;
    const fs::path scene_file = data / "nff" / (GetParam() + ".nff");
    std::ifstream table(data / "tables" / "spd_published_ray_counts.csv");
    if (!table || !fs::exists(scene_file)) GTEST_SKIP() << "the SPD scenes are not here: " << scene_file;
    std::map<std::string, double> published;
    for (std::string line; std::getline(table, line);) {
        std::vector<std::string> cells;
        std::stringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
        if (cells.at(0) != GetParam()) continue;
        published = {{"eye", std::stod(cells.at(5))},
                     {"reflect", std::stod(cells.at(6))},
                     {"refract", std::stod(cells.at(7))},
                     {"shadow", std::stod(cells.at(8))}};
    }
    ASSERT_FALSE(published.empty());
    const Scene scene = read_scene(scene_file);
    const RayScene rays(scene, 0);
    const CameraModel camera(scene.cameras.at(0), 0, {.width = 512, .height = 512});
    const WhittedTracer tracer(rays, camera, {.max_depth = 5, .min_contribution = 0});
    const RayCounts counts =
        sample_corners(tracer, {0, 512, 0, 512}, {.levels = 0}, [](const RecordBand&) {});
    const auto within = [&](const char* what, std::uint64_t got, double share) {
        EXPECT_LE(std::abs(static_cast<double>(got) - published.at(what)), share * published.at(what))
            << what << ": " << got << ", published " << published.at(what);
    };
    EXPECT_EQ(counts.eye, 513U * 513U);
    within("eye", counts.eye_hits, 0.0002);
    within("reflect", counts.reflect, 0.1);
    within("refract", counts.refract, 0.1);
    within("shadow", counts.shadow, 0.1);
    RecordProperty("reflect", std::to_string(counts.reflect));
    std::printf(
        "%s: eye hits %llu, reflect %llu, refract %llu, shadow %llu\n", GetParam().c_str(),
        static_cast<unsigned long long>(counts.eye_hits), static_cast<unsigned long long>(counts.reflect),
        static_cast<unsigned long long>(counts.refract), static_cast<unsigned long long>(counts.shadow));
}
INSTANTIATE_TEST_SUITE_P(Spd, PublishedRayCounts, testing::Values("balls", "tetra", "mount"));

}  // namespace
}  // namespace postlens::test::sampling_test
