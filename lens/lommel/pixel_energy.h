// Computes the energy in each square pixel from the encircled energy.
#pragma once

#include "lens/lommel/radial_profile.h"
#include "lens/response_grid.h"

namespace postlens {

/// Sampling density along pixel borders; the defaults are converged (docs/diffraction.md).
struct PixelEnergySettings {
    int nodes = 16;      ///< along a pixel border, per px of radius, away from the centre
    double near_px = 4;  ///< within this distance of the centre, every fringe is resolved
};

/// Fills `grid`, whose window the caller chooses, with the energy of the response centred at (centre_x,
/// centre_y) px from the grid's anchor. The energy in a pixel is the outflow through its borders: the radial
/// flow L(r) / (2 pi r), L being the encircled energy, has the energy density as its divergence. Neighbouring
/// pixels share the flow through their border, so the sum over any window is exactly the energy inside it.
/// The profile must extend to `reach_px(grid, ..)`. Values that rounding makes negative are set to 0.
void fill_pixel_energy(const RadialProfile& profile, double centre_x, double centre_y,
                       const PixelEnergySettings& settings, ResponseGrid& grid);

/// Radius to which the profile must extend for `fill_pixel_energy`, px.
[[nodiscard]] double reach_px(const ResponseGrid& grid, double centre_x, double centre_y,
                              const PixelEnergySettings& settings);

}  // namespace postlens
