// Exposure: in memory a value of 1 is white; files hold radiance.
#include "pictures/exposure.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/error.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "records/sample_file.h"
#include "tests/support/scene_builder.h"
#include "tests/support/temporary_folder.h"
#include "tracer/exposure.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::exposure_test {
namespace {

/// A floor, a mirror ball and a glass ball under a point light, with all light multiplied by `brighter`.
Scene lit_scene(double brighter) {
    SceneBuilder b;
    b.add(square({0, -1, -6}, {0, 1, 0}, 20), matte({0.7, 0.5, 0.3}));
    Material dim_mirror = mirror(0.3);
    dim_mirror.diffuse = glm::dvec3(0.4);
    b.add(Sphere{{-1, 0, -6}, 1}, dim_mirror);
    b.add(Sphere{{1.2, 0, -5}, 0.8}, glass(1.5, 0.9));
    b.add(Sphere{{0, 1.6, -7}, 0.4}, glowing(glm::dvec3(0.9) * brighter));
    b.point_light({2, 5, -2}, glm::dvec3(3) * brighter);
    b.scene.background = glm::dvec3(0.05, 0.1, 0.2) * brighter;
    b.scene.ambient_light = glm::dvec3(0.2) * brighter;
    return b.scene;
}

RecordBand all_of(const SampleFileReader& file) {
    RecordBand band;
    file.read(file.y_begin(), file.y_end(), band);
    return band;
}

Image image_of(std::vector<float> rgb) {
    Image out(static_cast<int>(rgb.size() / 3), 1);
    out.rgb = std::move(rgb);
    return out;
}

TEST(Exposure, AutoIsTheNearestRankOfWhatIsLit) {
    std::vector<double> values;
    for (int i = 1; i <= 20; ++i) values.push_back(i);  // rank 19 of 20
    values.insert(values.begin() + 5, 0.0);
    values.push_back(-3);
    values.push_back(INFINITY);
    values.push_back(NAN);
    EXPECT_EQ(auto_exposure_of(values), -std::log2(19.0));
    std::vector<double> one{0.25}, none{0, 0};
    EXPECT_EQ(auto_exposure_of(one), 2);
    EXPECT_EQ(auto_exposure_of(none), 0);
    std::vector<double> far{1e-40};
    EXPECT_EQ(auto_exposure_of(far), most_exposure_stops);
    Image image = image_of({0, 8, 0, 0, 0, 0});
    image.exposure_stops = 5;  // a value of 8 is a radiance of 1/4
    EXPECT_EQ(auto_exposure_of(image), 2);
}

TEST(Exposure, APreviewOfConstantLightIsItsOwnWhite) {
    SceneBuilder b;
    b.scene.background = glm::dvec3(0.5, 4, 1);
    for (const double stops : {0.0, 3.0, -7.0}) {
        expose(b.scene, stops);
        EXPECT_EQ(auto_exposure_stops(b.scene, "", {}), -2) << stops;
    }
}

TEST(Exposure, AutoDoesNotDependOnSizeOrThreads) {
    const Scene scene = lit_scene(1);
    const double stops = auto_exposure_stops(scene, "", {});
    EXPECT_NE(stops, 0);
    EXPECT_EQ(auto_exposure_stops(scene, "", {.width = 640, .height = 480}), stops);
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(auto_exposure_stops(scene, "", {}), stops) << threads;
    }
}

TEST(Exposure, ABrighterSceneAtItsOwnExposureTracesTheSameTree) {
    const TemporaryFolder folder;
    std::array<TraceResult, 2> results;
    const std::array brighter{1.0, 1000.0};
    for (std::size_t i = 0; i < 2; ++i) {
        Scene scene = lit_scene(brighter[i]);
        TraceSettings settings;
        // This limit ends paths of this scene at 0 stops, but would end none of the brighter scene.
        settings.whitted.min_contribution = 0.05;
        settings.auto_exposure_stops = auto_exposure_stops(scene, "", {});
        expose(scene, *settings.auto_exposure_stops);
        results[i] = trace_to_file(scene, settings, folder.path() / (i == 0 ? "a.exr" : "b.exr"));
    }
    EXPECT_EQ(results[0].records, results[1].records);
    EXPECT_EQ(results[0].rays.reflect, results[1].rays.reflect);
    EXPECT_EQ(results[0].rays.refract, results[1].rays.refract);
    EXPECT_EQ(results[0].rays.shadow, results[1].rays.shadow);
    const SampleFileReader a(folder.path() / "a.exr", Damage::refuse, 0.0),
        b(folder.path() / "b.exr", Damage::refuse, 0.0), b_exposed(folder.path() / "b.exr");
    EXPECT_NEAR(a.header().exposure_stops - b.header().exposure_stops, std::log2(1000.0), 1e-6);
    const RecordBand of_a = all_of(a), of_b = all_of(b), exposed = all_of(b_exposed);
    ASSERT_EQ(of_a.records.size(), of_b.records.size());
    const double gain = std::exp2(b.header().exposure_stops);
    for (std::size_t i = 0; i < of_a.records.size(); ++i) {
        const Record &p = of_a.records[i], &q = of_b.records[i];
        EXPECT_EQ(p.path, q.path);
        // Tolerance: a few roundings of floats, 6e-8 each.
        EXPECT_NEAR(static_cast<double>(q.g), 1000 * static_cast<double>(p.g),
                    1e-6 * 1000 * static_cast<double>(p.g));
        EXPECT_EQ(exposed.records[i].g, static_cast<float>(static_cast<double>(q.g) * gain));
    }
    // Without its exposure, the brighter scene has more records.
    Scene scene = lit_scene(1000);
    TraceSettings settings;
    settings.whitted.min_contribution = 0.05;
    EXPECT_GT(trace_to_file(scene, settings, folder.path() / "c.exr").records, results[0].records);
}

TEST(Exposure, SampleFilesKeepItAndImagesOfThemKnowIt) {
    const TemporaryFolder folder;
    Scene scene = lit_scene(1);
    TraceSettings settings;
    settings.auto_exposure_stops = -1.25;
    (void)trace_to_file(scene, settings, folder.path() / "zero.exr");
    scene.lumens_per_watt = 683;
    expose(scene, 3);
    settings.whitted.min_contribution = 8e-3;  // at 3 stops, the same radiance as 1e-3
    (void)trace_to_file(scene, settings, folder.path() / "three.exr");
    const SampleFileReader zero(folder.path() / "zero.exr"), three(folder.path() / "three.exr"),
        two(folder.path() / "three.exr", Damage::refuse, 2.0);
    EXPECT_EQ(zero.header().exposure_stops, 0);
    EXPECT_FALSE(zero.header().lumens_per_watt);
    EXPECT_EQ(three.header().exposure_stops, 3);
    EXPECT_EQ(three.header().auto_exposure_stops, -1.25);
    EXPECT_EQ(three.header().lumens_per_watt, 683);
    EXPECT_EQ(three.exposure_stops(), 3);
    EXPECT_EQ(two.exposure_stops(), 2);
    const Image at_zero = zero.picture(), at_two = two.picture();
    EXPECT_EQ(at_two.exposure_stops, 2);
    for (const Image& image :
         {pinhole_picture(two),
          focus_picture(two, {.lens = {50, 8}, .focus_distance_m = 5, .method = FocusMethod::scatter}).image})
        EXPECT_EQ(image.exposure_stops, 2);
}

TEST(Exposure, FilesWithoutItAreReadAsBefore) {
    const SampleFileReader file(std::string(POSTLENS_TEST_DATA) + "/records/without_exposure.exr");
    EXPECT_EQ(file.exposure_stops(), 0);
    EXPECT_FALSE(file.header().auto_exposure_stops);
    EXPECT_FALSE(file.header().lumens_per_watt);
    EXPECT_FALSE(file.header().metres_per_unit);
    EXPECT_EQ(pinhole_picture(file).rgb, file.picture().rgb);
}

TEST(Exposure, ImagesKeepItInEveryFormat) {
    const TemporaryFolder folder;
    Image image = image_of({0.25F, 0.5F, 1, 2, 0.125F, 0});
    image.exposure_stops = -2.7;
    for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr"}) {
        write_image(folder.path() / name, image);
        EXPECT_EQ(read_image(folder.path() / name).exposure_stops, -2.7) << name;
    }
    const Image exposed = read_image(folder.path() / "a.exr"),
                stored = read_image(folder.path() / "a.exr", PictureValues::stored);
    EXPECT_EQ(stored.exposure_stops, 0);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        EXPECT_NEAR(exposed.rgb[i], image.rgb[i], 2e-7F * image.rgb[i]);
        EXPECT_NEAR(stored.rgb[i], image.rgb[i] * std::exp2(2.7F), 1e-6F * stored.rgb[i]);
    }
    image.exposure_stops = 0;
    write_image(folder.path() / "a.exr", image);
    EXPECT_EQ(read_image(folder.path() / "a.exr").rgb, image.rgb);
    for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
        write_image(folder.path() / name, image);
        EXPECT_EQ(read_image(folder.path() / name).exposure_stops, 0) << name;
    }
    image.exposure_stops.reset();
    for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
        write_image(folder.path() / name, image);
        EXPECT_FALSE(read_image(folder.path() / name).exposure_stops) << name;
    }
}

TEST(Exposure, ADamagedNumberIsAnError) {
    for (const char* text : {"", "x", "1e9", "nan", "1 ", "inf"})
        EXPECT_THROW((void)stops_of_text(text, "a.png"), Error) << text;
    EXPECT_EQ(stops_of_text("-3.5", "a.png"), -3.5);
}

TEST(Exposure, RaysAreExposedAsWell) {
    Scene scene = lit_scene(1);
    RenderSettings settings;
    settings.spp = 4;
    settings.camera = {.width = 16, .height = 12};
    settings.tracing.min_contribution = 0;
    const Image at_zero = render_picture(scene, settings).image;
    expose(scene, 4);
    const Image at_four = render_picture(scene, settings).image;
    EXPECT_EQ(at_four.exposure_stops, 4);
    for (std::size_t i = 0; i < at_zero.rgb.size(); ++i) EXPECT_EQ(at_four.rgb[i], 16 * at_zero.rgb[i]);
}

TEST(Exposure, WarnsOfWhatIsBeyondWhiteAndOfWhatIsTooDark) {
    std::vector<float> rgb(3 * 100, 0.5F);
    for (std::size_t i = 0; i < 20; ++i) rgb[3 * i] = 4;
    EXPECT_FALSE(exposure_warning(image_of(rgb), std::nullopt));
    rgb[3 * 20 + 2] = 4;
    Image image = image_of(rgb);
    image.exposure_stops = 5;
    const auto bright = exposure_warning(image, std::nullopt);
    ASSERT_TRUE(bright);
    EXPECT_EQ(bright->share, 0.21);
    // A value of 4 at 5 stops is white at 3 stops.
    EXPECT_EQ(bright->text,
              "21 % of the pixels are brighter than white (expected --exposure 3.0, or --exposure auto)");
    EXPECT_FALSE(exposure_warning(image, Crop{30, 0, 50, 1}));
    const auto dark = exposure_warning(image_of(std::vector<float>(30, 1.0F / 256)), std::nullopt);
    ASSERT_TRUE(dark);
    EXPECT_EQ(dark->text,
              "every pixel is darker than 1/255 of white (expected --exposure 8.0, or --exposure auto)");
    EXPECT_FALSE(exposure_warning(image_of(std::vector<float>(30, 1.0F / 254)), std::nullopt));
    EXPECT_FALSE(exposure_warning(image_of(std::vector<float>(30, 0.0F)), std::nullopt));
}

}  // namespace
}  // namespace postlens::test::exposure_test
