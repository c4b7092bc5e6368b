// Impulse responses with diffraction of a circular aperture on the pixel grid, for many depths at once.
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
    /// The grid ends at the radius beyond which at most this share of the energy lies; > 0, < 1. The tail
    /// falls only with 1/r: it is 0.01 at 10 lambda V/D from the edge of the disc, 0.001 at 100 lambda V/D.
    double tail = 0.01;
    double max_radius_px = 1024;  ///< largest radius of the grid, for any tail
    /// true: the energy beyond the grid is added to the pixels in proportion to their energy; the sum is 1.
    /// false: that energy is lost, and the sum is 1 - loss.
    bool fold_tail = true;
    PixelEnergySettings pixels;
};

/// The responses of the three channels at one depth. All three grids have the same window; pixels that lie
/// wholly beyond `radius_px` of the centre hold 0.
struct ChannelResponses {
    std::array<ResponseGrid, 3> channel;
    std::array<double, 3> loss{};  ///< share of the energy beyond the grid, also if fold_tail adds it
    double radius_px = 0;
};

/// Computes the responses for each signed CoC diameter (px, FocusGeometry::coc_diameter_px), in the order
/// given. Only the absolute value matters, because without aberrations the light in front of and behind the
/// focus is the same. v_per_px(lambda) comes from the geometry; u = v_per_px coc / 2. Throws
/// Error(wrong_arguments) for an aperture of width 0, whose diffraction is unbounded, for CoCs that are not
/// finite or beyond `largest_u`, and for settings out of range; Error(out_of_memory), with the memory needed,
/// if the tables do not fit. Runs the depths in parallel; results are bit-identical for any number of
/// threads.
[[nodiscard]] std::vector<ChannelResponses> diffraction_responses(const FocusGeometry& geometry,
                                                                  std::span<const double> coc_diameters_px,
                                                                  const DiffractionSettings& settings);

/// Radius v beyond which at most the share `tail` of the energy lies, from the formula (2/pi) v/(v^2 - u^2).
/// The formula overestimates near the edge, so the result is never less than the true radius minus one
/// fringe.
[[nodiscard]] double radius_of_tail(double u, double tail);

}  // namespace postlens
