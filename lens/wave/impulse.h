// What --impulse names: the kinds of impulse response.
#pragma once

#include <string_view>
#include <vector>

namespace postlens {

struct Impulse {
    enum class Kind {
        disc,         ///< geometric: a uniform disc of the CoC's diameter
        diffraction,  ///< of the unfocused circular aperture, by Lommel's functions
    };
    Kind kind = Kind::disc;
    std::vector<double> wavelengths_nm;  ///< of `diffraction`; empty: those that the caller has
};

/// "disc", "diffraction" or "diffraction:NM[,NM...]". Throws Error(wrong_arguments), with the option's name,
/// for anything else and for wavelengths that `check_wavelength` refuses.
[[nodiscard]] Impulse parse_impulse(std::string_view option, std::string_view text);

}  // namespace postlens
