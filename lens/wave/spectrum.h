// Which wavelengths each colour channel sees.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace postlens {

/// One wavelength and its weight in the channels R, G, B.
struct SpectralLine {
    double wavelength_nm = 550;
    std::array<double, 3> weight = {1, 1, 1};
};

/// Lines whose weights are 1 in sum for every channel.
using Spectrum = std::vector<SpectralLine>;

/// The channels' own bands under white light: seven lines from 440 to 632 nm, 32 nm apart, with the weights
/// cos^2(pi (lambda - c) / (2 w)) for |lambda - c| < w, w = 64 nm, made 1 in sum, c = 611, 549 and 464 nm:
/// the dominant wavelengths of Rec.709's primaries against D65 [itu-bt709]. Weights of a matching function
/// would be negative in places, and no response may be. A band of one line has fringes that no camera shows;
/// these have three or four lines each.
[[nodiscard]] Spectrum channel_bands();

/// The same light in every channel: each wavelength with the same weight. Throws Error(wrong_arguments) for
/// an empty list, for more than 64 and for wavelengths that `check_wavelength` refuses.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
