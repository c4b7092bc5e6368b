// From encircled energy to the energy in each square pixel.
#pragma once

#include "lens/response_grid.h"
#include "lens/wave/radial_profile.h"

namespace postlens {

/// How finely the borders of pixels are sampled; the defaults are converged (docs/diffraction.md).
struct PixelEnergySettings {
    int nodes = 16;      ///< to a pixel of radius along a border, away from the centre
    double near_px = 4;  ///< within this distance of the centre every fringe is followed
};

/// Fills `grid` (its window is the caller's choice) with the energy of the response whose centre lies at
/// (centre_x, centre_y) px from the grid's anchor. No pixel is sampled: the radial flow L(r) / (2 pi r),
/// whose divergence is the energy's density, is integrated along the borders, so that neighbours share what
/// flows between them and the sum over any window is what its outline encloses. The profile must reach
/// `reach_px(grid, ..)`. Values that rounding leaves below 0 are made 0.
void fill_pixel_energy(const RadialProfile& profile, double centre_x, double centre_y,
                       const PixelEnergySettings& settings, ResponseGrid& grid);

/// How far the profile has to reach, px.
[[nodiscard]] double reach_px(const ResponseGrid& grid, double centre_x, double centre_y,
                              const PixelEnergySettings& settings);

}  // namespace postlens
