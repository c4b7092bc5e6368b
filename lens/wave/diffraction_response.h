// Impulse responses of a circular aperture with diffraction, on the pixel grid, for many depths at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lens/focus_geometry.h"
#include "lens/lommel/pixel_energy.h"
#include "lens/response_grid.h"
#include "lens/wave/spectrum.h"

namespace postlens {

struct DiffractionSettings {
    Spectrum spectrum = channel_bands();
    double centre_x = 0, centre_y = 0;  ///< geometric image, px from the anchor
    /// At most this share of the energy lies beyond the edge of the grid; > 0, < 1. The share decreases only
    /// as 1 / radius: it is 0.01 at a distance of 10 lambda V/D from the disc's edge, and 0.001 at 100 lambda
    /// V/D.
    double tail = 0.01;
    double max_radius_px = 1024;  ///< largest radius of the grid, for any tail
    /// true: the energy beyond the grid is added to the pixels in proportion to their energy, so that the sum
    /// is 1. false: that energy is lost, so the sum is 1 - loss.
    bool fold_tail = true;
    PixelEnergySettings pixels;
};

/// The responses of the three colour channels at one depth. All three grids have the same window. Pixels that
/// lie completely beyond `radius_px` of the centre are 0.
struct ChannelResponses {
    std::array<ResponseGrid, 3> channel;
    std::array<double, 3> loss{};  ///< share of the energy beyond the grid, even if added by fold_tail
    double radius_px = 0;
};

/// Computes the responses for each signed CoC diameter (px, FocusGeometry::coc_diameter_px), in the given
/// order. The sign has no effect, because without aberrations the light in front of and behind the focus is
/// equal. The geometry gives v_per_px for each wavelength, and u = v_per_px coc / 2. Throws
/// Error(wrong_arguments) for an aperture of width 0 (its diffraction is unbounded), for a CoC that is not
/// finite or exceeds `largest_u`, and for settings out of range. Throws Error(out_of_memory), with the memory
/// needed, if the tables do not fit. Depths run in parallel; results are bit-identical for any number of
/// threads.
[[nodiscard]] std::vector<ChannelResponses> diffraction_responses(const FocusGeometry& geometry,
                                                                  std::span<const double> coc_diameters_px,
                                                                  const DiffractionSettings& settings);

/// Radius v beyond which at most the share `tail` of the energy lies, by the formula (2/pi) v/(v^2 - u^2).
/// Near the disc's edge, the formula overestimates the share. So the result is at least the true radius minus
/// one fringe.
[[nodiscard]] double radius_of_tail(double u, double tail);

}  // namespace postlens
