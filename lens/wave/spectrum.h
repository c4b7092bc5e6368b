// Wavelengths and their weights in the colour channels.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace postlens {

/// One wavelength with its weights in the channels R, G and B.
struct SpectralLine {
    double wavelength_nm = 550;
    std::array<double, 3> weight = {1, 1, 1};
};

/// Spectral lines whose weights add up to 1 in every channel.
using Spectrum = std::vector<SpectralLine>;

/// A band of wavelengths per channel, under white light: seven lines from 440 to 632 nm, 32 nm apart. Their
/// weights are cos^2(pi (lambda - c) / (2 w)) for |lambda - c| < w, normalised to the sum 1. w = 64 nm; c =
/// 611, 549 and 464 nm, the dominant wavelengths of the Rec.709 primaries against D65 [itu-bt709]. Colour
/// matching functions cannot be used, because some of their weights would be negative. Each band has three or
/// four lines, because a single line would cause fringes that no camera shows.
[[nodiscard]] Spectrum channel_bands();

/// Gives each wavelength the same weight in every channel. Throws Error(wrong_arguments) for an empty list,
/// for more than 64 wavelengths, or if `check_wavelength` rejects a wavelength.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
