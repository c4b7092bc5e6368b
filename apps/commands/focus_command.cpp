#include <cmath>

#include "apps/command.h"
#include "apps/commands/plan_command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/numbers.h"
#include "apps/open_frame.h"
#include "core/counted.h"
#include "core/text.h"
#include "focus/bend_warning.h"
#include "focus/usual_method.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/read_prescription.h"
#include "pictures/crop.h"
#include "records/pixel_samples.h"
#include "sweep/picture_maker.h"

namespace postlens {

double asked_or_named(const std::optional<double>& asked, const std::optional<double>& named,
                      const char* option, const char* file) {
    if (asked) return *asked;
    if (named) return *named;
    fail(ExitCode::wrong_arguments, "{}: missing (got nothing; expected a value, as the {} names none)",
         option, file);
}

Prescription read_lens(const std::filesystem::path& path, std::vector<Warning>& warnings) {
    Prescription lens = read_prescription(path);
    for (const std::string& note : lens.notes) warnings.push_back({"lens", note});
    return lens;
}

void take_from_prescription(const Impulse& impulse, LensOptions& lens, std::vector<Warning>& warnings) {
    check_impulse(impulse);
    const Prescription prescription = read_lens(impulse.file, warnings);
    if (lens.focal_length_mm) {
        fail(ExitCode::wrong_arguments,
             "--focal-length: not with a real lens (got {} mm; expected nothing, as {} has its own)",
             *lens.focal_length_mm, prescription.file);
    }
    const FirstOrder first = first_order(prescription, prescription.wavelength_nm);
    lens.focal_length_mm = first.efl_mm;
    if (!lens.f_number) lens.f_number = first.f_number;
}

nlohmann::ordered_json json_number(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

void check_sufficient(const SampleHeader& h, const ThinLens& lens, std::vector<Warning>& out) {
    const std::optional<double>& smallest = h.sufficient.smallest_f_number;
    // Converts the f-number of `lens`, so that it can be compared with the smallest f-number for which the
    // file was traced. The two are defined differently. The sample file's f-number is film distance /
    // aperture diameter, but that of `lens` is focal length / aperture diameter.
    const double f_number = lens.f_number * h.film_distance_mm / lens.focal_length_mm;
    constexpr double rounding = 1e-9;
    if (!smallest || f_number >= *smallest * (1 - rounding)) return;
    out.push_back(
        {"insufficient",
         fmt::format("the file was traced for f-numbers from {} on at {:.6g} mm (got {:.6g} at {:.6g} mm)",
                     *smallest, h.film_distance_mm, lens.f_number, lens.focal_length_mm)});
}

ResolvedLens resolve_lens(const LensOptions& options, const SampleFileReader& file) {
    const SampleHeader& h = file.header();
    ResolvedLens out;
    out.lens.focal_length_mm = options.focal_length_mm.value_or(h.focal_length_mm);
    out.lens.f_number = asked_or_named(options.f_number, h.f_number, "--f-number", "sample file");
    out.focus_m = options.focus_at ? depth_at(file, options.focus_at->first, options.focus_at->second)
                                   : asked_or_named(options.focus_m, h.focus_m, "--focus", "sample file");
    return out;
}

CommandResult run_focus(const FocusOptions& options) {
    check_output(options.output);
    check_target(options.target_db, options.method);
    // A damaged header may hide the format of a file. So with --salvage, the input is assumed to be a sample
    // file, and not an image of another program (`is_foreign`).
    if (!options.salvage && is_foreign(options.input)) return focus_foreign(options);
    refuse_foreign_options(options.foreign, options.input);
    // For sample files, the options --metres-per-unit and --lumens-per-watt are checked here. A file of
    // another format is not checked: open_frame below rejects it, with an error that states the real cause.
    if (SampleFileReader::is_sample_file(options.input)) check_units(options.retrace);
    const Damage damage = damage_rule(options.salvage);
    const auto open = open_frame(options.input, options.kept,
                                 exposure_of_samples(options.exposure, options.input, damage), damage);
    const SampleFileReader& file = open->file;
    FocusFrame& frame = open->frame;
    check_crop(options.crop, file.header().width, file.header().height);
    LensOptions lens_options = options.lens;
    if (options.method == FocusMethod::pinhole) {
        // A pinhole image needs neither --f-number nor --focus: the f-number is infinite, and the focus
        // distance has no effect.
        lens_options.f_number = std::numeric_limits<double>::infinity();
        if (!lens_options.focus_m && !lens_options.focus_at)
            lens_options.focus_m = file.header().focus_m.value_or(1.0);
    }
    CommandResult out;
    if (options.impulse.kind == ImpulseKind::lens)
        take_from_prescription(options.impulse, lens_options, out.warnings);
    const ResolvedLens lens = resolve_lens(lens_options, file);
    const bool unplanned = options.takes_usual_method();
    const UsualMethod usual = usual_method(file.header());
    const FocusMethod method = unplanned ? usual.method : options.method;
    check_counts(options.depths, options.views, method);
    check_depth_options(options.spacing, options.depth_model, method);
    if (options.retrace.scene) check_traces_rays("--scene", method);
    if (options.retrace.explain) check_traces_rays("--explain", method);
    const FocusSettings settings{.lens = lens.lens,
                                 .focus_distance_m = lens.focus_m,
                                 .framing = options.lens.framing,
                                 .method = method,
                                 .spacing = options.spacing,
                                 .depth_model = options.depth_model,
                                 .impulse = options.impulse,
                                 .depths = options.depths,
                                 .views = options.views.value_or(default_lens_views),
                                 .crop = options.crop};
    const bool predict = options.predict && method != FocusMethod::automatic;
    if (predict) {
        if (method == FocusMethod::pinhole || std::isinf(lens.lens.f_number)) {
            fail(ExitCode::wrong_arguments,
                 "--predict: not of a pinhole's picture, which is the mean of its records (got {}; expected "
                 "a finite --f-number and a method other than pinhole)",
                 options.method == FocusMethod::pinhole ? "--method pinhole" : "--f-number inf");
        }
        check_predictable(file.header(), settings);
    }
    warn_of_missing_rows(file, out.warnings);
    FocusResult result;
    HybridResult hybrid;
    nlohmann::ordered_json plan = nullptr;
    // With a pinhole, views (images seen from single lens points) are all seen from the same point, so they
    // are not needed. But if the user names the scene, the views are made nevertheless, because rays find
    // surfaces that are too small for the samples in the file.
    const bool has_views = std::isfinite(lens.lens.f_number) || options.retrace.scene;
    if (method == FocusMethod::automatic && has_views) {
        AutoResult planned = run_auto(frame, {.hybrid = {.focus = settings}, .target_db = options.target_db},
                                      options.retrace, options.output, out);
        plan = auto_json(planned);
        hybrid = std::move(planned.hybrid);
        result = std::move(hybrid.focus);
        result.method = FocusMethod::automatic;
        out.text = planned.plan + "\n";
    } else if (method == FocusMethod::hybrid && has_views) {
        hybrid = run_hybrid(frame, {.focus = settings}, options.retrace, options.output, out);
        result = std::move(hybrid.focus);
        result.method = FocusMethod::hybrid;
    } else {
        result = focus_picture(frame, settings);
    }
    check_sufficient(file.header(), lens.lens, out.warnings);
    for (const FocusWarning& w : result.warnings) out.warnings.push_back({w.code, w.text, w.share});
    // Adds a warning if some reflections or refractions are blurred inaccurately. When the lens point moves,
    // the image of a reflected or refracted object moves on the raster. A sample file describes this motion
    // as linear, but in a curved mirror, for example, it may be strongly nonlinear.
    if (result.method != FocusMethod::pinhole && options.depth_model == DepthModel::ray_differentials &&
        !options.retrace.scene) {
        const SampleHeader& h = file.header();
        const auto bends = bend_warning(frame,
                                        focus_geometry(lens.lens, lens.focus_m, options.lens.framing,
                                                       {h.film_distance_mm, h.pixel_pitch_mm}),
                                        options.lens.framing == Framing::keep ? options.crop : std::nullopt);
        if (bends) out.warnings.push_back({bends->code, bends->text, bends->share});
    }
    if (options.strict && !out.warnings.empty()) out.exit_code = ExitCode::shortfall;
    const bool told = unplanned && result.method == method;  // false if the lens is a pinhole
    out.json = {{"method", method_name(result.method)},
                {"method_reason", told ? nlohmann::ordered_json(usual.reason) : nullptr},
                {"views", result.views > 0 ? nlohmann::ordered_json(result.views) : nullptr},
                {"depths", result.depths},
                {"predicted_db", nullptr},
                {"retraced_share", hybrid.retraced_share},
                {"focus_m", json_number(lens.focus_m)},
                {"focal_length_mm", lens.lens.focal_length_mm},
                {"f_number", json_number(lens.lens.f_number)},
                {"impulse", impulse_text(options.impulse)},
                {"largest_coc_px", json_number(result.largest_coc_px)}};
    if (!plan.is_null())
        out.json.update(plan);
    else if (result.method == FocusMethod::hybrid)
        out.json.update(shares_json(hybrid));
    out.text +=
        fmt::format("{}: {}x{} px, {}, F = {:.4g} mm, f/{:.4g}, focus {:.4g} m, {}, widest CoC {}",
                    options.output, result.image.width, result.image.height, method_name(result.method),
                    lens.lens.focal_length_mm, lens.lens.f_number, lens.focus_m,
                    result.views > 0 ? counted(result.views, "view") : counted(result.depths, "depth"),
                    px_text(result.largest_coc_px));
    if (hybrid.stated) {
        out.text += fmt::format(", {:.1f} dB ({:.1f} to {:.1f}), {} % rays", hybrid.stated->db(),
                                hybrid.stated->low_db(), hybrid.stated->high_db(),
                                rough(100 * hybrid.retraced_share));
    }
    if (told) out.text += fmt::format("\n  {}, {}", method_name(method), usual.reason);
    if (predict && !hybrid.stated) {
        report_prediction(predict_error(frame, {.focus = settings}, result.image, result.views), out);
    }
    if (options.output.empty()) out.ray_share = cut(hybrid.traced, result.image.width, options.crop);
    deliver(std::move(result.image), {options.output, options.crop, options.made_by, options.shared}, out);
    return out;
}

}  // namespace postlens
