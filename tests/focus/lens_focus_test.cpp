// Real lenses: the focused image against rays through the same prescription. The scene is one plane, so
// nothing is hidden.
#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/threads.h"
#include "focus/focus.h"
#include "lens/prescription/read_prescription.h"
#include "tests/focus/mosaic.h"
#include "tests/support/reference.h"
#include "tests/support/temporary_folder.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens::test::lens_focus_test {
namespace {

constexpr double depth_m = 0.8;
constexpr double tile_m = 0.034;
const std::string lenses = std::string(POSTLENS_TEST_DATA) + "/lens/";
const std::string biotar = lenses + "lentil_0009.toml", retrofocus = lenses + "lentil_0004.toml",
                  double_gauss = lenses + "rayoptics_ag_dblgauss.seq";

class LensFocus : public testing::Test {
  protected:
    // Traces the scene once, in the first test, because a temporary folder needs the name of a test.
    void SetUp() override {
        if (scene_ != nullptr) return;
        scene_ = new Scene(mosaic(depth_m, tile_m));
        // The corner of the image is at 12 degrees, within the field that these lenses are designed for.
        scene_->cameras.front().focal_length_mm = 100;
        folder_ = new TemporaryFolder();
        TraceSettings settings;
        settings.overscan_px = 12;
        settings.subdivision.levels = 3;
        trace_to_file(*scene_, settings, folder_->path() / "frame.exr");
        file_ = new SampleFileReader(folder_->path() / "frame.exr");
        frame_ = new FocusFrame(*file_, true);
    }
    static void TearDownTestSuite() {
        delete frame_;
        delete file_;
        delete folder_;
        delete scene_;
    }
    static FocusResult focused(const std::string& lens, double focus_m, double f_number,
                               Framing framing = Framing::keep) {
        return focus_picture(*frame_, {.lens = {.focal_length_mm = 100, .f_number = f_number},
                                       .focus_distance_m = focus_m,
                                       .framing = framing,
                                       .impulse = {.kind = ImpulseKind::lens, .file = lens}});
    }
    static Reference rays(const std::string& lens, double focus_m, std::optional<double> f_number,
                          Framing framing = Framing::keep, int spp = 256) {
        RenderSettings s;
        s.f_number = f_number;
        s.focus_m = focus_m;
        s.framing = framing;
        s.spp = spp;
        s.prescription = std::make_shared<Prescription>(read_prescription(lens));
        return reference(*scene_, s);
    }

    static inline Scene* scene_ = nullptr;
    static inline TemporaryFolder* folder_ = nullptr;
    static inline SampleFileReader* file_ = nullptr;
    static inline FocusFrame* frame_ = nullptr;
};

// The noise of the rays is higher than in ImpulseFocus, because they are aimed at a rectangle larger than the
// pupil. It is about as large as the error of the image, and is subtracted. The total light has noise, and an
// error because the table is linear between steps of 1/20 of the field.
TEST_F(LensFocus, AgreesWithRaysThroughTheSamePrescription) {
    struct Case {
        std::string lens;
        double focus_m, f_number;
    };
    for (const Case& c :
         {Case{biotar, 0.5, 1.4368}, Case{biotar, HUGE_VAL, 2}, Case{retrofocus, 0.45, 2.6362},
          Case{double_gauss, 0.5, 2.0002}, Case{double_gauss, 3, 2.8}}) {
        const FocusResult got = focused(c.lens, c.focus_m, c.f_number);
        const Reference truth = rays(c.lens, c.focus_m, c.f_number);
        const std::string what = fmt::format("{} f/{} at {} m", c.lens, c.f_number, c.focus_m);
        EXPECT_GT(psnr(got.image, truth, 12), 49) << what;
        EXPECT_NEAR(mean(got.image) / mean(truth.image), 1, 5e-3) << what;
        // Shows that this test can fail: a thin lens of the same focal length and f-number loses no light and
        // has round responses.
        const Image thin = focus_picture(*frame_, {.lens = {.focal_length_mm = 100, .f_number = c.f_number},
                                                   .focus_distance_m = c.focus_m})
                               .image;
        EXPECT_GT(psnr(got.image, truth, 12), psnr(thin, truth, 12) + 3) << what;
    }
}

TEST_F(LensFocus, FramingMovesTheFilmOfBoth) {
    for (const Framing framing : {Framing::lens, Framing::breathing}) {
        const FocusResult got = focused(double_gauss, 0.6, 2.8, framing);
        const Reference truth = rays(double_gauss, 0.6, 2.8, framing);
        EXPECT_NEAR(mean(got.image) / mean(truth.image), 1, 5e-3);
        // Magnifying the image reduces accuracy as with a thin lens; steps of the field cost up to 3 dB more.
        RenderSettings s;
        s.focal_length_mm = 100;
        s.f_number = 2.8;
        s.focus_m = 0.6;
        s.framing = framing;
        s.spp = 256;
        const Reference thin_truth = reference(*scene_, s);
        const Image thin = focus_picture(*frame_, {.lens = {.focal_length_mm = 100, .f_number = 2.8},
                                                   .focus_distance_m = 0.6,
                                                   .framing = framing})
                               .image;
        EXPECT_GT(psnr(got.image, truth, 12), psnr(thin, thin_truth, 12) - 3);
    }
}

// Far from the axis, beyond the field that the lens is designed for, its responses are many pixels wide. In
// the middle of the image they are sharp.
TEST_F(LensFocus, LayersAreAsSharpAsScatter) {
    Scene wide = *scene_;
    wide.cameras.front().focal_length_mm = 40;
    TraceSettings settings;
    settings.overscan_px = 12;
    settings.subdivision.levels = 2;
    const TemporaryFolder folder;
    trace_to_file(wide, settings, folder.path() / "frame.exr");
    const SampleFileReader file(folder.path() / "frame.exr");
    FocusFrame frame(file, true);
    const auto by = [&](FocusMethod method) {
        return focus_picture(frame, {.lens = {.focal_length_mm = 4, .f_number = 4.5},
                                     .focus_distance_m = depth_m,
                                     .method = method,
                                     .impulse = {.kind = ImpulseKind::lens,
                                                 .file = lenses + "optiland_TessarLens.toml"}})
            .image;
    };
    // 52.7 dB measured. With samples placed in steps of a whole pixel: 32.9 dB.
    EXPECT_GT(psnr(by(FocusMethod::layers), by(FocusMethod::scatter), 12), 50);
}

TEST_F(LensFocus, SameBitsForAnyNumberOfThreads) {
    Image first_focus, first_rays;
    for (const int threads : {1, 5}) {
        const ThreadLimit limit(threads);
        const Image focus = focused(biotar, 0.3, 2).image,
                    traced = rays(biotar, 0.3, 2, Framing::keep, 4).image;
        if (threads == 1) first_focus = focus;
        if (threads == 1) first_rays = traced;
        EXPECT_TRUE(focus.rgb == first_focus.rgb) << threads;
        EXPECT_TRUE(traced.rgb == first_rays.rgb) << threads;
    }
}

TEST_F(LensFocus, RefusesWhatNoLensDoes) {
    const auto code = [](const auto& action) {
        try {
            (void)action();
        } catch (const Error& e) {
            return e.code();
        }
        return ExitCode::ok;
    };
    EXPECT_EQ(code([&] { return focused(lenses + "missing.toml", 1, 4); }), ExitCode::invalid_input);
    EXPECT_EQ(code([&] { return focused(biotar, 1, 1.2); }), ExitCode::wrong_arguments);    // opens to 1.44
    EXPECT_EQ(code([&] { return focused(biotar, 0.001, 4); }), ExitCode::wrong_arguments);  // no real image
    EXPECT_EQ(code([&] { return rays(biotar, 1, 1.2, Framing::keep, 2); }), ExitCode::wrong_arguments);
    EXPECT_EQ(code([&] {
                  RenderSettings s;
                  s.focal_length_mm = 50;
                  s.focus_m = 1;
                  s.prescription = std::make_shared<Prescription>(read_prescription(biotar));
                  return render_picture(*scene_, s);
              }),
              ExitCode::wrong_arguments);
    Scene parallel = *scene_;
    parallel.cameras.front().projection = Camera::Projection::orthographic;
    EXPECT_EQ(code([&] {
                  RenderSettings s;
                  s.prescription = std::make_shared<Prescription>(read_prescription(biotar));
                  return render_picture(parallel, s);
              }),
              ExitCode::wrong_arguments);
}

}  // namespace
}  // namespace postlens::test::lens_focus_test
