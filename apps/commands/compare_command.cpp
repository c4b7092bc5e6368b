#include <cmath>
#include <new>
#include <unistd.h>

#include "apps/command.h"
#include "apps/numbers.h"
#include "apps/scene_input.h"
#include "compare/comparison.h"
#include "compare/comparison_text.h"
#include "compare/drawing/cause_picture.h"
#include "compare/drawing/error_map.h"
#include "core/counted.h"
#include "motionblur/paths/paths_file.h"
#include "pictures/crop.h"
#include "pictures/exposure.h"
#include "planner/error_causes.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

void check_limits(const CompareLimits& limits) {
    const auto check = [](const char* option, const std::optional<double>& value, const char* expected) {
        if (value) in_range(option, *value, 0, true, expected);
    };
    check("--fail-psnr", limits.least_psnr_db, "0 dB or more");
    check("--fail-relmse", limits.greatest_relmse, "0 or more");
    check("--fail-flip", limits.greatest_flip, "0 to 1");
    if (limits.greatest_flip && *limits.greatest_flip > 1) {
        fail(ExitCode::wrong_arguments, "--fail-flip: out of range (got {}; expected 0 to 1)",
             *limits.greatest_flip);
    }
}

// Checks that all images have the size of the reference, and that they fit into memory. Reads only the
// headers of the files.
void check_files(const CompareCommandOptions& o) {
    const ImageSize size = read_image_size(o.reference);
    check_crop(o.crop, size.width, size.height);
    int pictures = 2;
    const auto check = [&](const std::string& path) {
        const ImageSize got = read_image_size(path);
        if (got != size) {
            fail(ExitCode::invalid_input, "{}: size differs from that of {} (got {}x{}; expected {}x{})",
                 path, o.reference, got.width, got.height, size.width, size.height);
        }
    };
    check(o.image);
    for (const auto* path : {&o.pinhole, &o.noise}) {
        if (!*path) continue;
        check(**path);
        ++pictures;
    }
    const std::uint64_t needed = comparison_bytes(size, pictures);
    const auto there = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                       static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    if (needed > there) {
        fail(ExitCode::out_of_memory,
             "{}: not enough memory to compare {}x{} pixels (needs {} MB; there are {} MB)", o.reference,
             size.width, size.height, needed >> 20U, there >> 20U);
    }
}

void add_figures(Json& json, const std::string& prefix, const Comparison& c, const Figures* f) {
    const auto add = [&](const char* name, double value) {
        json[prefix + name] = f != nullptr ? json_number(value) : Json(nullptr);
    };
    const Figures figures = f != nullptr ? *f : Figures();
    add("psnr_db", figures.errors.psnr_db);
    add("rmse", figures.errors.rmse);
    add("relmse", figures.errors.relmse);
    add("relmse_trimmed", figures.errors.relmse_trimmed);
    add("ssim", figures.ssim);
    add("flip", c.flip(figures));
    add("flip_ldr", figures.flip_ldr);
    add("flip_hdr", figures.flip_hdr);
}

void add_noise(Json& json, const std::string& prefix, const std::optional<NoiseFloor>& noise,
               bool image_is_a_reference) {
    const NoiseFloor n = noise.value_or(NoiseFloor());
    const auto add = [&](const std::string& name, bool known, const Json& value) {
        json[prefix + name] = known ? value : Json(nullptr);
    };
    const bool floor = noise.has_value();
    add("noise_psnr_db", floor, json_number(psnr_from_mse(n.reference_mse)));
    add("noise_rmse", floor, json_number(n.reference_rmse));
    add("noise_relmse", floor, json_number(n.reference_relmse));
    const bool above = floor && !image_is_a_reference;
    const auto psnr = [](double rms) { return json_number(psnr_from_mse(rms * rms)); };
    const NoisyError& e = n.encoded;
    add("psnr_above_noise_db", above,
        e.is_bound() ? psnr(e.greatest_rms()) : json_number(psnr_from_mse(e.mse)));
    add("psnr_above_noise_is_bound", above, e.is_bound());
    add("psnr_above_noise_range_db", above, {psnr(e.greatest_rms()), psnr(e.least_rms())});
    add("rmse_above_noise", above,
        json_number(n.linear.is_bound() ? n.linear.greatest_rms() : std::sqrt(n.linear.mse)));
    add("rmse_above_noise_is_bound", above, n.linear.is_bound());
    const double relative_rms = n.relative.greatest_rms();
    add("relmse_above_noise", above,
        json_number(n.relative.is_bound() ? relative_rms * relative_rms : n.relative.mse));
    add("relmse_above_noise_is_bound", above, n.relative.is_bound());
}

Json json_of(const Comparison& c, bool with_pinhole) {
    Json json;
    add_figures(json, "", c, &c.whole);
    json["affected_share"] = with_pinhole ? json_number(*c.affected_share) : Json(nullptr);
    add_figures(json, "affected_", c, c.affected ? &*c.affected : nullptr);
    json["pinhole_psnr_db"] = c.pinhole ? json_number(c.pinhole->psnr_db) : Json(nullptr);
    json["pinhole_affected_psnr_db"] =
        c.pinhole_affected ? json_number(c.pinhole_affected->psnr_db) : Json(nullptr);
    add_noise(json, "", c.noise, c.image_is_a_reference);
    add_noise(json, "affected_", c.affected_noise, c.image_is_a_reference);
    json["flip_kind"] = c.within_range ? "ldr" : "hdr";
    json["flip_exposures"] = {
        {"start", c.exposures.start}, {"stop", c.exposures.stop}, {"count", c.exposures.count}};
    json["identical"] = c.identical;
    json["clipped_share"] = c.clipped_share;
    json["nonfinite_pixels"] = c.nonfinite.any;
    json["nonfinite_image_pixels"] = c.nonfinite.image;
    json["nonfinite_reference_pixels"] = c.nonfinite.reference;
    json["width"] = c.width;
    json["height"] = c.height;
    return json;
}

void warn_of_nonfinite(const Comparison& c, const CompareCommandOptions& o, CommandResult& out) {
    const double pixels = static_cast<double>(c.width) * c.height;
    const auto warn = [&](const std::string& path, std::size_t bad) {
        if (bad == 0) return;
        const double share = static_cast<double>(bad) / pixels;
        out.warnings.push_back({"nonfinite",
                                fmt::format("{}: NaN or infinity in {} ({:.3g} %): left out", path,
                                            counted(bad, "pixel"), 100 * share),
                                share});
    };
    warn(o.image, c.nonfinite.image);
    warn(o.reference, c.nonfinite.reference);
    if (o.pinhole) warn(*o.pinhole, c.nonfinite.pinhole);
    if (o.noise) warn(*o.noise, c.nonfinite.second_reference);
}

void warn_of_noise(const Comparison& c, const CompareCommandOptions& o, CommandResult& out) {
    if (!o.noise) return;
    if (c.references_are_equal) {
        out.warnings.push_back(
            {"same_reference",
             fmt::format("{} and {} are the same picture bit for bit: they tell nothing of the "
                         "reference's noise (expected renders with different seeds)",
                         o.reference, *o.noise)});
        return;
    }
    if (c.image_is_a_reference) {
        out.warnings.push_back(
            {"image_is_reference",
             fmt::format("{} is a reference itself, bit for bit: its error above the noise "
                         "cannot be told",
                         o.image)});
        return;
    }
    // If two references are equally good, an image is about equally near to both. `preference` is the
    // difference between the image's two squared errors, in standard errors. By chance, its magnitude exceeds
    // 4 only once in 16000 images.
    if (c.noise && std::abs(c.noise->preference) > 4) {
        out.warnings.push_back(
            {"unlike_references",
             fmt::format(
                 "{} is nearer to {} than chance allows ({:.1f} standard errors): the references are not "
                 "equally good, or the image was made from one of them",
                 o.image, c.noise->preference < 0 ? o.reference : *o.noise, std::abs(c.noise->preference))});
    }
    if (c.noise && c.noise->linear.mse < -4 * c.noise->linear.standard_error) {
        out.warnings.push_back(
            {"dependent_references",
             "the error above the noise comes out negative: image and references are not independent"});
    }
}

void warn_of_range(const Comparison& c, CommandResult& out) {
    if (c.whole.errors.rmse > 0 && std::isinf(c.whole.errors.psnr_db)) {
        out.warnings.push_back(
            {"beyond_range", "the pictures differ only where PSNR does not see it: outside 0..1 (see RMSE)",
             c.clipped_share});
    }
    if (c.nonfinite.any == static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height))
        out.warnings.push_back(
            {"no_pixels", "no pixel is finite in both pictures: there is nothing to compare", 1});
}

std::string text_of(const Comparison& c, const CompareCommandOptions& o,
                    const std::vector<std::string>& failures) {
    std::string text = fmt::format("{} against {}, {}x{} px\n", o.image, o.reference, c.width, c.height);
    text += aligned(figures_table(c));
    for (const std::string& note : comparison_notes(c)) text += note + "\n";
    for (const std::string& failure : failures) text += "FAILED: " + failure + "\n";
    return text;
}

Image read_part(const std::string& path, const std::optional<Crop>& crop) {
    Image image = read_image(path);
    if (crop) image = cut(image, crop);
    return image;
}

// Converts all images of a comparison to one exposure, so that their values are comparable. This exposure is
// the value of the option --exposure. Without this option, it is the exposure stored with the reference, or
// else that of the tested image, or else 0.
class Exposer {
  public:
    Exposer(const CompareCommandOptions& o, const Image& reference, const Image& image)
        : stops_(o.exposure.automatic ? auto_exposure_of(reference)
                                      : o.exposure.stops.value_or(reference.exposure_stops.value_or(
                                            image.exposure_stops.value_or(0)))),
          crop_(o.crop) {}
    [[nodiscard]] double stops() const { return stops_; }
    // An image with unknown exposure stays unchanged.
    void bring(Image& image) const { set_exposure(image, stops_); }
    [[nodiscard]] Image read(const std::string& path) const {
        Image image = read_part(path, crop_);
        bring(image);
        return image;
    }

  private:
    double stops_;
    std::optional<Crop> crop_;
};

// Finds the cause of each pixel's error, for example a surface that the sample file does not contain. Writes
// an image that shows the causes. Also reports, for each cause, the fraction of the whole error that it
// explains.
void map_causes(const CompareCommandOptions& o, const Exposer& exposer, CommandResult& out) {
    const SampleFileReader file(*o.frame, Damage::refuse, exposer.stops());
    warn_of_missing_rows(file, out.warnings);
    LensOptions lens = o.lens;
    const SampleHeader& h = file.header();
    if (o.shutter && !lens.f_number) lens.f_number = std::numeric_limits<double>::infinity();
    if (lens.f_number && std::isinf(*lens.f_number) && !lens.focus_m) lens.focus_m = h.focus_m.value_or(1.0);
    const ResolvedLens of = resolve_lens(lens, file);
    const FrameMotion motion = motion_of(h, {});
    CauseRequest request;
    request.view.focus = {.lens = of.lens, .focus_distance_m = of.focus_m};
    request.view.motion = &motion;
    request.view.shutter = o.shutter;
    request.method = o.method;
    request.depths = o.depths;
    std::optional<Scene> scene;
    if (o.retrace.scene) {
        scene = read_scene_of_file(*o.retrace.scene, o.retrace.metres_per_unit, o.retrace.lumens_per_watt,
                                   file, {*o.map_causes}, out);
        request.view.scene = &*scene;
    }
    const Image image = exposer.read(o.image), reference = exposer.read(o.reference);
    FocusFrame frame(file);
    const CauseMap map = find_error_causes(frame, image, reference, request);
    write_image(*o.map_causes, cause_picture(map, reference));
    Json shares = Json::object();
    for (std::size_t c = 1; c < error_causes; ++c) {
        shares[std::string(cause_name(static_cast<ErrorCause>(c)))] = map.error_share[c];
        if (map.error_share[c] > 0)
            out.text += fmt::format("{:5.1f} % of the error: {}\n", 100 * map.error_share[c],
                                    cause_name(static_cast<ErrorCause>(c)));
    }
    out.json["cause_shares"] = shares;
}

CommandResult compare_files(const CompareCommandOptions& o) {
    check_files(o);
    CompareInput input;
    input.reference = read_part(o.reference, o.crop);
    input.image = read_part(o.image, o.crop);
    const Exposer exposer(o, input.reference, input.image);
    exposer.bring(input.image);
    exposer.bring(input.reference);
    if (o.pinhole) input.pinhole = exposer.read(*o.pinhole);
    if (o.noise) input.second_reference = exposer.read(*o.noise);
    input.flip_white_luminance = o.flip_white;
    const Comparison c = compare_pictures(std::move(input));

    const std::vector<std::string> failures = failed_limits(c, o.limits);
    CommandResult out;
    out.json = json_of(c, o.pinhole.has_value());
    out.json["failed"] = failures;
    out.json["exposure_stops"] = exposer.stops();
    out.text = text_of(c, o, failures);
    if (!failures.empty()) out.exit_code = ExitCode::comparison_failed;
    warn_of_part(o.image, out.warnings);
    warn_of_part(o.reference, out.warnings);
    for (const auto* path : {&o.pinhole, &o.noise}) {
        if (*path) warn_of_part(**path, out.warnings);
    }
    warn_of_nonfinite(c, o, out);
    warn_of_noise(c, o, out);
    warn_of_range(c, out);
    if (o.map || o.side_by_side) {
        // The comparison has freed the image and the reference to save memory, so they are read again.
        const Image image = exposer.read(o.image), reference = exposer.read(o.reference);
        if (o.map) write_image(*o.map, error_map(image, reference));
        if (o.side_by_side) {
            std::vector<std::string> lines = comparison_notes(c);
            for (const std::string& failure : failures) lines.push_back("FAILED: " + failure);
            write_image(*o.side_by_side, side_by_side(image, reference, figures_table(c), lines));
        }
    }
    if (o.map_causes) map_causes(o, exposer, out);
    return out;
}

}  // namespace

CommandResult run_compare(const CompareCommandOptions& options) {
    check_limits(options.limits);
    if (options.flip_white) in_range("--flip-white", *options.flip_white, 0, false, "more than 0");
    if (options.map_causes.has_value() != options.frame.has_value()) {
        fail(ExitCode::wrong_arguments, "--map-causes: goes with --frame (got one of them; expected both)");
    }
    if (options.retrace.scene && !options.map_causes)
        fail(ExitCode::wrong_arguments, "--scene: goes with --map-causes (got it alone)");
    if (options.crop && options.map_causes)
        fail(ExitCode::wrong_arguments, "--crop: not with --map-causes (got both; expected one of them)");
    check_units(options.retrace);
    for (const auto* path : {&options.map, &options.side_by_side, &options.map_causes}) {
        if (*path) check_image_path(**path);
    }
    try {
        return compare_files(options);
    } catch (const std::bad_alloc&) {
        const ImageSize size = read_image_size(options.reference);
        const int pictures = 2 + (options.pinhole ? 1 : 0) + (options.noise ? 1 : 0);
        fail(ExitCode::out_of_memory, "{}: not enough memory to compare {}x{} pixels (needs about {} MB)",
             options.reference, size.width, size.height, comparison_bytes(size, pictures) >> 20U);
    }
}

}  // namespace postlens
