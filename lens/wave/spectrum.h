// Wavelengths and their weights in each colour channel.
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

/// Lines whose weights add up to 1 in every channel.
using Spectrum = std::vector<SpectralLine>;

/// A band of wavelengths per channel, under white light: seven lines from 440 to 632 nm, 32 nm apart, with
/// the weights cos^2(pi (lambda - c) / (2 w)) for |lambda - c| < w, normalised to the sum 1. w = 64 nm; c =
/// 611, 549 and 464 nm, the dominant wavelengths of the Rec.709 primaries against D65 [itu-bt709]. Colour
/// matching functions are unsuitable, because their weights are negative in places. A single line would cause
/// fringes that no camera shows, so each band has three or four lines.
[[nodiscard]] Spectrum channel_bands();

/// Gives each wavelength the same weight in every channel. Throws Error(wrong_arguments) for an empty list,
/// for more than 64 wavelengths and for wavelengths that `check_wavelength` refuses.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
