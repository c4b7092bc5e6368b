#include "lens/impulse.h"

#include <charconv>
#include <cmath>

#include "core/error.h"

namespace postlens {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> out;
    std::size_t begin = 0;
    for (std::size_t end = text.find(at); end != std::string::npos; end = text.find(at, begin)) {
        out.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    out.push_back(text.substr(begin));
    return out;
}

double number_in(const std::string& option, const std::string& what, const std::string& text, double low,
                 double high) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stopped != end || !(value >= low && value <= high)) {
        fail(ExitCode::wrong_arguments, "{}: {} is out of range (got {}; expected {} to {})", option, what,
             text.empty() ? "nothing" : text, low, high);
    }
    return value;
}

Impulse polygon(const std::string& option, const std::string& text) {
    const std::vector<std::string> parts = split(text, ':');
    Impulse out{.kind = ImpulseKind::polygon};
    if (parts.size() > 3) {
        fail(ExitCode::wrong_arguments,
             "{}: too many numbers (got {}; expected polygon:BLADES[:DEG[:ROUNDNESS]])", option, text);
    }
    const double blades = number_in(option, "the number of blades", parts[0], 3, 64);
    out.blades = static_cast<int>(blades);
    if (out.blades != blades)
        fail(ExitCode::wrong_arguments, "{}: blades are whole (got {}; expected 3 to 64)", option, parts[0]);
    if (parts.size() > 1) out.rotation_deg = number_in(option, "the angle", parts[1], -360, 360);
    if (parts.size() > 2) out.roundness = number_in(option, "the roundness", parts[2], 0, 1);
    return out;
}

}  // namespace

Impulse parse_impulse(const std::string& option, const std::string& text, bool real_lenses) {
    const std::size_t colon = text.find(':');
    const std::string word = text.substr(0, colon);
    const bool has_rest = colon != std::string::npos;
    const std::string rest = has_rest ? text.substr(colon + 1) : "";
    if (word == "disc" && !has_rest) return {};
    if (word == "polygon" && has_rest) return polygon(option, rest);
    if (word == "diffraction") {
        Impulse out{.kind = ImpulseKind::diffraction};
        if (has_rest) {
            for (const std::string& part : split(rest, ','))
                out.wavelengths_nm.push_back(number_in(option, "the wavelength in nm", part,
                                                       shortest_wavelength_nm, longest_wavelength_nm));
        }
        return out;
    }
    if (word == "image" && !rest.empty()) return {.kind = ImpulseKind::picture, .file = rest};
    if (word == "lens" && !rest.empty() && real_lenses) return {.kind = ImpulseKind::lens, .file = rest};
    fail(ExitCode::wrong_arguments,
         "{}: unknown impulse response (got {}; expected disc, polygon:BLADES[:DEG[:ROUNDNESS]], "
         "diffraction[:NM[,NM...]]{} image:FILE{})",
         option, text, real_lenses ? "," : " or", real_lenses ? " or lens:PRESCRIPTION" : "");
}

std::string file_of_impulse(const std::string& text) {
    for (const std::string kind : {"image:", "lens:"}) {
        if (text.starts_with(kind)) return text.substr(kind.size());
    }
    return "";
}

void check_impulse(const Impulse& i) {
    const auto in_range = [](const char* option, double value, double low, double high) {
        if (value >= low && value <= high) return;
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {} to {})", option, value, low,
             high);
    };
    in_range("--squeeze", i.squeeze, 0.1, 10);
    in_range("--cats-eye", i.cats_eye, 0, 1.5);
    in_range("--spherical", i.spherical, -10, 10);
    const bool geometric =
        i.kind == ImpulseKind::disc || i.kind == ImpulseKind::polygon || i.kind == ImpulseKind::picture;
    if (geometric || (i.squeeze == 1 && i.cats_eye == 0 && i.spherical == 0)) return;
    fail(ExitCode::wrong_arguments, "{}: not for --impulse {} (expected disc, polygon or image)",
         i.squeeze != 1    ? "--squeeze"
         : i.cats_eye != 0 ? "--cats-eye"
                           : "--spherical",
         impulse_text(i));
}

std::string impulse_text(const Impulse& i) {
    switch (i.kind) {
        case ImpulseKind::disc:
            return "disc";
        case ImpulseKind::polygon:
            return fmt::format("polygon:{}:{}:{}", i.blades, i.rotation_deg, i.roundness);
        case ImpulseKind::picture:
            return "image:" + i.file.string();
        case ImpulseKind::lens:
            return "lens:" + i.file.string();
        case ImpulseKind::diffraction: {
            std::string out = "diffraction";
            for (std::size_t k = 0; k < i.wavelengths_nm.size(); ++k)
                out += fmt::format("{}{}", k == 0 ? ":" : ",", i.wavelengths_nm[k]);
            return out;
        }
    }
    return "";
}

}  // namespace postlens
