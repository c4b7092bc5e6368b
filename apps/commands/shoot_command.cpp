#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/commands/plan_command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/open_frame.h"
#include "core/counted.h"
#include "motionblur/motion_warnings.h"
#include "motionblur/paths/paths_file.h"
#include "pictures/crop.h"
#include "scene/scene.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

/// Warns of shadows, lighting and reflections that should change while surfaces move, but were recorded at a
/// single instant.
void warn_of_unseen_motion(const SampleFileReader& file, const FrameMotion& motion, const Exposure& exposure,
                           CommandResult& out) {
    constexpr int rows_at_once = 64;
    const SampleHeader& h = file.header();
    if (file.instants() > 1) return;
    std::vector<std::uint32_t> moving = motion.moving_ids();
    std::sort(moving.begin(), moving.end());
    UnseenMotion unseen(h, std::move(moving), exposure);
    if (!unseen.possible()) return;
    RecordBand band;
    for (int y = 0; y < h.height; y += rows_at_once) {
        const int end = std::min(y + rows_at_once, h.height);
        file.read(y, end, band);
        unseen.add(band, y, end);
    }
    for (const MotionWarning& w : unseen.warnings()) out.warnings.push_back({w.code, w.text, w.share});
}

}  // namespace

CommandResult run_shoot(const ShootOptions& options) {
    const FocusOptions& o = options.focus;
    check_output(o.output);
    check_target(o.target_db, o.method);
    check_counts(o.depths, o.views, o.method);
    check_units(o.retrace);
    const Damage damage = damage_rule(o.salvage);
    const auto open = open_frame(o.input, o.kept, exposure_of_samples(o.exposure, o.input, damage), damage);
    const SampleFileReader& file = open->file;
    FocusFrame& frame = open->frame;
    const SampleHeader& h = file.header();
    check_crop(o.crop, h.width, h.height);
    const ResolvedLens lens = resolve_lens(o.lens, file);
    const Exposure exposure = resolve_exposure(options.shutter, h, options.shutter_from_frame);
    check_exposure(exposure);
    const FrameMotion motion =
        motion_of(h, options.paths ? read_paths(*options.paths) : std::vector<ObjectPath>());
    CommandResult out;
    warn_of_missing_rows(file, out.warnings);
    const HybridSettings settings{.focus = {.lens = lens.lens,
                                            .focus_distance_m = lens.focus_m,
                                            .framing = o.lens.framing,
                                            .method = o.method,
                                            .impulse = o.impulse,
                                            .views = o.views.value_or(default_shutter_views),
                                            .crop = o.crop},
                                  .motion = &motion,
                                  .shutter = TimeSpan{exposure.open_s, exposure.close_s},
                                  .curve = shutter_curve(options.curve)};
    const bool automatic = o.method == FocusMethod::automatic;
    const bool predict = o.predict && !automatic;
    if (predict) check_predictable(h, settings.focus);
    AutoResult planned;
    if (automatic) {
        planned = run_auto(frame, {.hybrid = settings, .target_db = o.target_db}, o.retrace, o.output, out);
    } else {
        planned.hybrid = run_hybrid(frame, settings, o.retrace, o.output, out);
    }
    HybridResult& result = planned.hybrid;
    check_sufficient(h, lens.lens, out.warnings);
    check_sufficient(h, exposure, out.warnings);
    for (const FocusWarning& w : result.focus.warnings) out.warnings.push_back({w.code, w.text, w.share});
    if (!o.retrace.scene) warn_of_unseen_motion(file, motion, exposure, out);
    if (o.strict && !out.warnings.empty()) out.exit_code = ExitCode::shortfall;
    const char* method = automatic ? "auto" : o.method == FocusMethod::hybrid ? "hybrid" : "lightfield";
    const int views = automatic ? result.focus.views : settings.focus.views;
    out.json = {{"method", method},
                {"views", views},
                {"depths", nullptr},
                {"predicted_db", nullptr},
                {"retraced_share", result.retraced_share},
                {"focus_m", json_number(lens.focus_m)},
                {"focal_length_mm", lens.lens.focal_length_mm},
                {"f_number", json_number(lens.lens.f_number)},
                {"shutter_open_s", exposure.open_s},
                {"shutter_close_s", exposure.close_s},
                {"instants", file.instants()}};
    out.json.update(automatic ? auto_json(planned) : shares_json(result));
    if (automatic) out.text = planned.plan + "\n";
    out.text += fmt::format(
        "{}: {}x{} px, {}, {}, F = {:.4g} mm, f/{:.4g}, focus {:.4g} m, shutter {:.6g} to {:.6g} s, "
        "{:.1f} % "
        "traced again",
        o.output, result.focus.image.width, result.focus.image.height, method, counted(views, "view"),
        lens.lens.focal_length_mm, lens.lens.f_number, lens.focus_m, exposure.open_s, exposure.close_s,
        100 * result.retraced_share);
    if (predict && !result.stated) {
        report_prediction(predict_error(frame, settings, result.focus.image, views), out);
    }
    if (o.output.empty()) out.ray_share = cut(result.traced, result.focus.image.width, o.crop);
    deliver(std::move(result.focus.image), {o.output, o.crop, o.made_by, o.shared}, out);
    return out;
}

}  // namespace postlens
