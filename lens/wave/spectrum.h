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

/// Returns a band of wavelengths for each channel, under white light. The bands consist of seven spectral
/// lines from 440 to 632 nm, 32 nm apart. The weight of a line is cos^2(pi (lambda - c) / (2 w)) for |lambda
/// - c| < w, scaled so that the weights of a channel add up to 1. The half width w is 64 nm. The centres c of
/// R, G and B are 611, 549 and 464 nm. They are the dominant wavelengths of the Rec.709 primaries against D65
/// [itu-bt709].
///
/// Colour matching functions are not used, because some weights would be negative. Each band has three or
/// four lines, because a single line would cause fringes that no camera shows.
[[nodiscard]] Spectrum channel_bands();

/// Returns a spectrum in which all wavelengths have equal weight in every channel.
///
/// Throws Error(wrong_arguments) for an empty list, more than 64 wavelengths, or one that `check_wavelength`
/// rejects.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
