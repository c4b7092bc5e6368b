#include "sweep/picture_maker.h"

#include <cmath>
#include <utility>

#include "core/error.h"
#include "focus/usual_method.h"
#include "motionblur/motion_blur.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {
namespace {

FocusMethod method_for(const PictureSettings& settings, const SampleHeader& header, bool with_shutter) {
    const std::optional<FocusMethod>& asked = settings.method;
    const FocusMethod usual = with_shutter ? FocusMethod::lightfield : FocusMethod::automatic;
    check_target(settings.target_db, asked.value_or(usual));
    if (!asked && with_shutter) return FocusMethod::lightfield;
    if (!with_shutter && asked.value_or(FocusMethod::automatic) == FocusMethod::automatic &&
        !settings.target_db && settings.scene == nullptr)
        return usual_method(header).method;
    if (!asked) return FocusMethod::automatic;
    if (with_shutter && *asked != FocusMethod::lightfield && *asked != FocusMethod::hybrid &&
        *asked != FocusMethod::automatic) {
        fail(ExitCode::wrong_arguments,
             "--method: not with a shutter (got {}; expected lightfield, hybrid or auto, or no --shutter)",
             method_name(*asked));
    }
    return *asked;
}

MadePicture made(FocusResult&& r, const char* method) {
    return {std::move(r.image), method, r.depths, r.views, r.geometry, std::move(r.warnings), {}};
}

}  // namespace

void check_target(const std::optional<double>& target_db, FocusMethod method) {
    if (target_db && method != FocusMethod::automatic) {
        fail(ExitCode::wrong_arguments, "--target-db: not with the method {} (expected --method auto)",
             method_name(method));
    }
}

const char* method_name(FocusMethod method) {
    switch (method) {
        case FocusMethod::pinhole:
            return "pinhole";
        case FocusMethod::scatter:
            return "scatter";
        case FocusMethod::layers:
            return "layers";
        case FocusMethod::lightfield:
            return "lightfield";
        case FocusMethod::hybrid:
            return "hybrid";
        case FocusMethod::automatic:
            break;
    }
    return "auto";
}

void check_counts(const std::optional<int>& depths, const std::optional<int>& views, FocusMethod method) {
    using enum FocusMethod;
    if (depths && method != scatter && method != layers) {
        fail(ExitCode::wrong_arguments, "--depths: not with the method {} (expected scatter or layers)",
             method_name(method));
    }
    if (views && method != lightfield && method != hybrid) {
        fail(ExitCode::wrong_arguments, "--views: not with the method {} (expected lightfield or hybrid)",
             method_name(method));
    }
}

void check_depth_options(DepthSpacing spacing, DepthModel model, FocusMethod method) {
    using enum FocusMethod;
    if (spacing != DepthSpacing::inverse && method != scatter && method != layers) {
        fail(ExitCode::wrong_arguments, "--spacing: not with the method {} (expected scatter or layers)",
             method_name(method));
    }
    if (model != DepthModel::ray_differentials && method != scatter && method != layers &&
        method != pinhole) {
        fail(ExitCode::wrong_arguments,
             "--depth-model: {} knows what is seen in mirrors by W (expected W, or scatter or layers)",
             method_name(method));
    }
}

void check_traces_rays(std::string_view name, FocusMethod method) {
    if (method == FocusMethod::hybrid || method == FocusMethod::automatic) return;
    fail(ExitCode::wrong_arguments,
         "{}: not with the method {}, which traces no rays (expected hybrid or auto)", name,
         method_name(method));
}

PictureMaker::PictureMaker(const SampleFileReader& file, PictureSettings settings, bool with_shutter)
    : file_(file),
      settings_(std::move(settings)),
      method_(method_for(settings_, file.header(), with_shutter)),
      frame_(file, true) {
    check_counts(settings_.depths, settings_.views, method_);
    check_depth_options(settings_.spacing, settings_.depth_model, method_);
    if (settings_.scene != nullptr && !with_shutter) check_traces_rays("--scene", method_);
    if (with_shutter) motion_.emplace(motion_of(file.header(), settings_.paths));
}

MadePicture PictureMaker::make(const SweepSetting& s) {
    const FocusSettings focus{
        .lens = {.focal_length_mm = s.focal_length_mm, .f_number = s.f_number},
        .focus_distance_m = s.focus_m,
        .framing = settings_.framing,
        .method = method_,
        .spacing = settings_.spacing,
        .depth_model = settings_.depth_model,
        .impulse = s.impulse,
        .depths = settings_.depths,
        .views = settings_.views.value_or(s.shutter ? default_shutter_views : default_lens_views)};
    if (s.shutter) return moving(s, focus);
    const bool pinhole = std::isinf(s.f_number);
    if (method_ == FocusMethod::automatic && !pinhole) return planned({.focus = focus});
    if (method_ == FocusMethod::hybrid && !pinhole) return by_hybrid({.focus = focus});
    FocusResult r = focus_picture(frame_, focus);
    const FocusMethod method = r.method;
    MadePicture out = made(std::move(r), method_name(method));
    // The error of an image is predicted by comparison with a reference, which is a mean of many views. A
    // pinhole image is more accurate than this reference, so no error is predicted for it.
    if (method != FocusMethod::pinhole) predict(out, {.focus = focus});
    return out;
}

MadePicture PictureMaker::by_hybrid(HybridSettings settings) {
    settings.scene = settings_.scene;
    HybridResult r = hybrid_picture(frame_, settings);
    MadePicture out = made(std::move(r.focus), method_name(method_));
    if (r.stated)
        out.predicted_db = r.stated->db();
    else
        predict(out, settings);
    return out;
}

void PictureMaker::predict(MadePicture& picture, const HybridSettings& settings) {
    if (!settings_.predict) return;
    picture.predicted_db = predict_error(frame_, settings, picture.image, picture.views).predicted_db;
}

MadePicture PictureMaker::planned(HybridSettings settings) {
    settings.scene = settings_.scene;
    AutoResult r = auto_picture(frame_, {.hybrid = settings, .target_db = settings_.target_db});
    MadePicture out = made(std::move(r.hybrid.focus), method_name(FocusMethod::automatic));
    out.predicted_db = r.hybrid.stated ? r.hybrid.stated->db() : r.noise_db();
    return out;
}

MadePicture PictureMaker::moving(const SweepSetting& s, const FocusSettings& focus) {
    const HybridSettings settings{
        .focus = focus, .motion = &*motion_, .shutter = s.shutter, .curve = settings_.curve};
    if (std::isfinite(s.f_number)) {
        return method_ == FocusMethod::automatic ? planned(settings) : by_hybrid(settings);
    }
    MotionBlurResult r = motion_blur(file_, {.exposure = {s.shutter->open_s, s.shutter->close_s},
                                             .curve = settings_.curve,
                                             .views = settings_.views,
                                             .paths = settings_.paths});
    MadePicture out;
    out.image = std::move(r.image);
    out.method = "motionblur";
    out.views = r.views;
    const SampleHeader& h = file_.header();
    if (h.projection == Projection::perspective) {
        out.geometry = focus_geometry(focus.lens, focus.focus_distance_m, Framing::keep,
                                      {h.film_distance_mm, h.pixel_pitch_mm});
    }
    for (const MotionWarning& w : r.warnings) out.warnings.push_back({w.code, w.share, w.text});
    predict(out, settings);
    return out;
}

}  // namespace postlens
