#include "apps/lens/lens_fit_limits_command.h"

#include <cmath>
#include <numbers>

#include "apps/numbers.h"
#include "core/counted.h"
#include "lens/fits/sharp_range.h"
#include "lens/fits/thin_lens_fit.h"

namespace postlens {
namespace {

nlohmann::ordered_json error_json(const FittedNumber& number) {
    return number.standard_error ? json_number(*number.standard_error) : nullptr;
}

std::string with_error(const FittedNumber& number) {
    return number.standard_error ? fmt::format("{:.6g} +- {:.2g}", number.value, *number.standard_error)
                                 : fmt::format("{:.6g}", number.value);
}

CommandResult fit_pairs(const LensFitLimitsOptions& o) {
    const std::vector<CocPair> pairs = read_coc_pairs(*o.pairs);
    const ThinLensFit fit =
        fit_thin_lens(pairs, {.focal_length_mm = o.focal_length_mm, .f_number = o.f_number});
    CommandResult out;
    out.json = {{"focal_length_mm", fit.focal_length_mm.value},
                {"focal_length_error_mm", error_json(fit.focal_length_mm)},
                {"f_number", fit.f_number.value},
                {"f_number_error", error_json(fit.f_number)},
                {"focus_m", json_number(fit.focus_distance_m.value)},
                {"focus_error_m", error_json(fit.focus_distance_m)},
                {"rms_mm", fit.rms_mm},
                {"condition", json_number(fit.condition)},
                {"pairs", pairs.size()}};
    out.text = fmt::format("F = {} mm, f/{}, focused at {} m; {}, {:.3g} mm rms",
                           with_error(fit.focal_length_mm), with_error(fit.f_number),
                           with_error(fit.focus_distance_m), counted(pairs.size(), "pair"), fit.rms_mm);
    for (const std::string& doubt : fit.doubts)
        out.warnings.push_back({.code = "undetermined", .text = doubt});
    return out;
}

double coc_limit_mm(const LensFitLimitsOptions& o) {
    if (o.coc_limit_mm) return *o.coc_limit_mm;
    if (o.sensor_mm) return std::hypot(o.sensor_mm->first, o.sensor_mm->second) / 1500;
    fail(ExitCode::wrong_arguments,
         "--coc-limit: missing (got nothing; expected mm, or --sensor WxH, of whose diagonal a 1500th is "
         "taken)");
}

CommandResult fit_sharp(const LensFitLimitsOptions& o) {
    if (o.f_number) {
        fail(ExitCode::wrong_arguments, "--f-number: --sharp finds it (got {}; expected none)", *o.f_number);
    }
    const double limit_mm = coc_limit_mm(o);
    const SharpRange found = sharp_range({.near_m = o.sharp->first,
                                          .far_m = o.sharp->second,
                                          .coc_limit_mm = limit_mm,
                                          .focal_length_mm = o.focal_length_mm,
                                          .wavelength_nm = o.wavelength_nm});
    CommandResult out;
    out.json = {{"focus_m", found.focus_distance_m}, {"coc_limit_mm", limit_mm}};
    out.text = fmt::format(
        "focused at {:.6g} m, circles of confusion up to {:.4g} mm:", found.focus_distance_m, limit_mm);
    auto lenses = nlohmann::ordered_json::array();
    bool any = false;
    for (const SharpLens& lens : found.lenses) {
        nlohmann::ordered_json entry = {
            {"focal_length_mm", lens.focal_length_mm},
            {"f_number", lens.f_number > 0 ? json_number(lens.f_number) : nullptr},
            {"largest_f_number", lens.largest_f_number > 0 ? json_number(lens.largest_f_number) : nullptr},
            {"why_not", lens.why_not.empty() ? nullptr : nlohmann::ordered_json(lens.why_not)}};
        std::string view;
        if (o.sensor_mm) {
            // The film distance V determines the field of view.
            const double V_mm =
                lens.focal_length_mm / (1 - lens.focal_length_mm * 1e-3 / found.focus_distance_m);
            const double degrees = 360 / std::numbers::pi * std::atan(o.sensor_mm->first / (2 * V_mm));
            entry["view_degrees"] = V_mm > 0 ? json_number(degrees) : nullptr;
            if (V_mm > 0) view = fmt::format(", {:.3g} degrees wide", degrees);
        }
        lenses.push_back(entry);
        any = any || lens.why_not.empty();
        out.text += lens.why_not.empty()
                        ? fmt::format("\n{:>6g} mm: f/{:.3g} to f/{:.3g}{}", lens.focal_length_mm,
                                      lens.f_number, lens.largest_f_number, view)
                        : fmt::format("\n{:>6g} mm: no, {}{}", lens.focal_length_mm, lens.why_not, view);
    }
    out.json["lenses"] = lenses;
    out.json["possible"] = any;
    if (!any) {
        out.warnings.push_back({.code = "impossible",
                                .text = found.lenses.size() == 1
                                            ? "no aperture does: " + found.lenses[0].why_not
                                            : "none of the focal lengths does; each says why"});
    }
    return out;
}

}  // namespace

std::pair<double, double> parse_depths(const std::string& option, const std::string& text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos) {
        fail(ExitCode::wrong_arguments,
             "{}: not two depths (got {}; expected NEAR:FAR in metres, e.g. 1.2:4)", option, text);
    }
    return {parse_number(option, std::string_view(text).substr(0, colon)),
            parse_number(option, std::string_view(text).substr(colon + 1), true)};
}

std::pair<double, double> parse_sensor(const std::string& option, const std::string& text) {
    const std::size_t x = text.find('x');
    if (x == std::string::npos) {
        fail(ExitCode::wrong_arguments, "{}: not a size (got {}; expected WxH in mm, e.g. 36x24)", option,
             text);
    }
    return {in_range(option, parse_number(option, std::string_view(text).substr(0, x)), 0, false,
                     "more than 0 mm"),
            in_range(option, parse_number(option, std::string_view(text).substr(x + 1)), 0, false,
                     "more than 0 mm")};
}

CommandResult run_lens_fit_limits(const LensFitLimitsOptions& options) {
    if (options.pairs && options.sharp) {
        fail(ExitCode::wrong_arguments, "--sharp: --pairs is given as well (got both; expected one of them)");
    }
    if (options.pairs) return fit_pairs(options);
    if (options.sharp) return fit_sharp(options);
    fail(ExitCode::wrong_arguments,
         "lens fit: nothing to fit to (got no prescription, --pairs, --sharp or --picture; expected one of "
         "them)");
}

}  // namespace postlens
