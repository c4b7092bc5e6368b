#include "apps/commands/sweep_command.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "apps/exposure.h"
#include "apps/scene_input.h"
#include "core/counted.h"
#include "motionblur/paths/paths_file.h"
#include "sweep/values.h"

namespace postlens {
namespace {

std::vector<double> only(const std::optional<double>& value) {
    return value ? std::vector<double>{*value} : std::vector<double>{};
}

/// Returns the values of the settings with which a sweep makes its images, for example a list of f-numbers
/// and a list of focus distances. If the user states no list for a setting, the single value in the sample
/// file is used.
SweepAxes axes_of(const SweepOptions& o, const SampleHeader& h) {
    SweepAxes out;
    out.f_numbers = o.f_number ? f_number_list("--f-number", *o.f_number) : only(h.f_number);
    out.focus_m = o.focus ? focus_list("--focus", *o.focus) : only(h.focus_m);
    if (o.settings.picture.method == FocusMethod::pinhole) {
        // A pinhole image needs neither --f-number nor --focus: the f-number is infinite, and the focus
        // distance has no effect.
        if (!o.f_number) out.f_numbers = {std::numeric_limits<double>::infinity()};
        if (out.focus_m.empty()) out.focus_m = {1};
    }
    out.focal_lengths_mm =
        o.focal_length ? focal_length_list("--focal-length", *o.focal_length) : only(h.focal_length_mm);
    if (o.shutter) out.shutters = shutter_list("--shutter", *o.shutter);
    if (o.impulse) out.impulses = impulse_list("--impulse", *o.impulse);
    bool all_lenses = true;
    for (Impulse& i : out.impulses) {
        i.squeeze = o.modifiers.squeeze;
        i.cats_eye = o.modifiers.cats_eye;
        i.spherical = o.modifiers.spherical;
        check_impulse(i);
        const bool is_lens = i.kind == ImpulseKind::lens;
        if (is_lens && o.focal_length) {
            fail(ExitCode::wrong_arguments,
                 "--focal-length: not with a real lens (got {}; expected nothing, as {} has its own)",
                 *o.focal_length, i.file.string());
        }
        all_lenses = all_lenses && is_lens;
    }
    if (all_lenses && !o.f_number) out.f_numbers.clear();
    return out;
}

/// Sets the format of the images from the extension of --frames, for example "pull.%04d.png".
void take_format(const SweepOptions& o, SweepSettings& s) {
    if (s.frames) {
        for (const std::string ending : {"exr", "png", "tif", "jpg"}) {
            if (!s.frames->ends_with("." + ending)) continue;
            if (o.format && *o.format != ending) {
                fail(ExitCode::wrong_arguments,
                     "--frames: ends with another format than --format (got {} and {})", *s.frames,
                     *o.format);
            }
            s.frames->resize(s.frames->size() - ending.size() - 1);
            s.format = ending;
            return;
        }
        const std::string ending = std::filesystem::path(*s.frames).extension().string();
        const bool is_word =
            ending.size() > 1 && std::all_of(ending.begin() + 1, ending.end(),
                                             [](unsigned char c) { return std::isalpha(c) != 0; });
        if (is_word) {
            fail(ExitCode::wrong_arguments,
                 "--frames: unknown kind of image (got ending \"{}\"; expected .exr, .png, .tif or .jpg, or "
                 "none)",
                 ending);
        }
    }
    if (o.format) s.format = *o.format;
}

void warn(const SampleHeader& h, const SweepResult& result, std::vector<Warning>& out) {
    for (const SweepWarning& w : result.warnings) {
        out.push_back({w.worst.code,
                       fmt::format("{} of {}: {}", w.pictures, counted(result.table.rows.size(), "picture"),
                                   w.worst.text),
                       w.worst.share});
    }
    // Warns if the sample file was traced for a smaller aperture or a shorter exposure than some images of
    // the sweep need, because surfaces may then be missing. There is only one warning, with the number of
    // these images (`pictures`).
    std::vector<Warning> insufficient;
    std::size_t pictures = 0;
    for (const SweepRow& row : result.table.rows) {
        const SweepSetting& s = row.setting;
        const std::size_t before = insufficient.size();
        check_sufficient(h, ThinLens{.focal_length_mm = s.focal_length_mm, .f_number = s.f_number},
                         insufficient);
        if (s.shutter) check_sufficient(h, Exposure{s.shutter->open_s, s.shutter->close_s}, insufficient);
        pictures += insufficient.size() > before ? 1 : 0;
    }
    if (insufficient.empty()) return;
    out.push_back({insufficient.front().code,
                   fmt::format("{} of {}, e.g.: {}", pictures, counted(result.table.rows.size(), "picture"),
                               insufficient.front().text)});
}

}  // namespace

std::size_t pictures_of(const SweepOptions& o) {
    const SampleFileReader file(o.input, o.settings.damage);
    return sweep_grid(axes_of(o, file.header())).pictures.size();
}

CommandResult run_sweep(const SweepOptions& o) {
    SweepSettings settings = o.settings;
    take_format(o, settings);
    check_units(o.retrace);
    settings.exposure_stops = exposure_of_samples(o.exposure, o.input, settings.damage);
    std::optional<Scene> scene;
    CommandResult out;
    SampleHeader header;
    {
        const SampleFileReader file(o.input, settings.damage);
        header = file.header();
        warn_of_missing_rows(file, out.warnings);
        settings.axes = axes_of(o, header);
    }
    for (const Impulse& i : settings.axes.impulses)
        if (i.kind == ImpulseKind::lens) (void)read_lens(i.file, out.warnings);
    if (o.paths) {
        settings.picture.paths = read_paths(*o.paths);
        settings.depends_on.emplace_back(*o.paths);
    }
    settings.picture.curve = shutter_curve(o.curve);
    if (o.retrace.scene) {
        const SampleFileReader file(o.input, settings.damage, settings.exposure_stops);
        scene = read_scene_of_file(*o.retrace.scene, o.retrace.metres_per_unit, o.retrace.lumens_per_watt,
                                   file, {}, out);
        settings.picture.scene = &*scene;
    }
    const SweepResult result = sweep(o.input, settings, o.output);
    warn(header, result, out.warnings);
    const bool whole = !settings.share;
    if (whole && !result.contact_sheet) {
        out.warnings.push_back({"contact_sheet", fmt::format("of {} no contact sheet is made",
                                                             counted(result.table.rows.size(), "picture"))});
    }
    if (!result.missing.empty()) {
        const std::size_t all = result.table.rows.size() + result.missing.size();
        out.warnings.push_back(
            {"partial",
             fmt::format("{} of {} pictures are missing or not as their table says, e.g. {}",
                         result.missing.size(), all, result.missing.front()),
             static_cast<double>(result.missing.size()) / static_cast<double>(all)});
    }
    // The exposure affects only how images are displayed, so its warnings do not fail a command with
    // --strict.
    if (o.strict && std::any_of(out.warnings.begin(), out.warnings.end(),
                                [](const Warning& w) { return w.code != "exposure"; }))
        out.exit_code = ExitCode::shortfall;
    out.json = nlohmann::ordered_json::parse(json_text(result.table));
    out.json.update(
        {{"folder", o.output},
         {"made", result.made},
         {"kept", result.kept},
         {"csv", whole ? nlohmann::ordered_json(result.csv.string()) : nullptr},
         {"contact_sheet",
          result.contact_sheet ? nlohmann::ordered_json(result.contact_sheet->string()) : nullptr}});
    out.text = fmt::format("{}: {} ({} made, {} kept), {}{}{}", o.output,
                           counted(result.table.rows.size(), "picture"), result.made, result.kept,
                           whole ? "sweep.csv, " : "", result.json.filename().string(),
                           result.contact_sheet ? ", contact.png" : "");
    return out;
}

}  // namespace postlens
