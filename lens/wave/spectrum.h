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

/// Returns spectral lines that sample a band of wavelengths for each colour channel, under white light. The
/// lines lie 32 nm apart, from 440 to 632 nm. In each channel, the weight of the wavelength lambda is
/// proportional to
///
///     cos^2(pi (lambda - c) / (2 w))  for |lambda - c| < w = 64 nm
///
/// c is the centre of the channel's band: 611 nm for R, 549 nm for G, and 464 nm for B. These are the
/// dominant wavelengths of Rec.709 [itu-bt709].
[[nodiscard]] Spectrum channel_bands();

/// Returns a spectrum in which all wavelengths have equal weight in every channel.
///
/// Throws Error(wrong_arguments) for an empty list, more than 64 wavelengths, or one that `check_wavelength`
/// rejects.
[[nodiscard]] Spectrum equal_lines(std::span<const double> wavelengths_nm);

}  // namespace postlens
