#include "lens/wave/impulse.h"

#include "core/error.h"
#include "core/text.h"
#include "lens/wave/spectrum.h"

namespace postlens {
namespace {

std::vector<double> parse_wavelengths(std::string_view option, std::string_view list) {
    std::vector<double> out;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t comma = std::min(list.find(',', begin), list.size());
        const auto value = parse_number(list.substr(begin, comma - begin));
        if (!value) {
            fail(ExitCode::wrong_arguments, "{}: not a list of wavelengths (got {}; expected NM[,NM...])",
                 option, excerpt(list));
        }
        out.push_back(*value);
        begin = comma + 1;
    }
    (void)equal_lines(out);  // refuses what is out of range
    return out;
}

}  // namespace

Impulse parse_impulse(std::string_view option, std::string_view text) {
    constexpr std::string_view list = "diffraction:";
    if (text == "disc") return {.kind = Impulse::Kind::disc};
    if (text == "diffraction") return {.kind = Impulse::Kind::diffraction};
    if (text.starts_with(list)) {
        return {.kind = Impulse::Kind::diffraction,
                .wavelengths_nm = parse_wavelengths(option, text.substr(list.size()))};
    }
    fail(ExitCode::wrong_arguments,
         "{}: unknown impulse response (got {}; expected disc or diffraction[:NM[,NM...]])", option,
         excerpt(text));
}

}  // namespace postlens
