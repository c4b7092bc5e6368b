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

/// Returns a band of wavelengths for each channel, under white light: lines from 440 to 632 nm, 32 nm apart.
/// The weight at wavelength lambda is
///
///     cos^2(pi (lambda - c) / (2 w))  for |lambda - c| < w = 64 nm
///
/// The centres c (611, 549, 464 nm) are the dominant wavelengths of Rec.709 [itu-bt709].
[[nodiscard]] Spectrum channel_bands();

/// Returns a spectrum in which all wavelengths have equal weight in every channel.
///
/// Throws Error(wrong_arguments) for an empty list, more than 64 wavelengths, or one that `check_wavelength`
/// rejects.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
