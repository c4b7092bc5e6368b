// Computes the energy in each pixel from the encircled energy, which is the energy within each radius.
#pragma once

#include "lens/lommel/radial_profile.h"
#include "lens/response_grid.h"

namespace postlens {

/// How finely fill_pixel_energy samples its integrals along the borders of pixels. Finer sampling hardly
/// changes the results (docs/diffraction.md).
struct PixelEnergySettings {
    int nodes = 16;      ///< quadrature nodes along a pixel border, per px of radius
    double near_px = 4;  ///< distance from the centre up to which every fringe is resolved
};

/// Computes the energy of an impulse response in each pixel of `grid`. The impulse response is rotationally
/// symmetric, and its centre is at (centre_x, centre_y) px. `profile` gives the fraction of its energy within
/// each radius, at least up to the radius `reach_px(grid, ..)`.
void fill_pixel_energy(const RadialProfile& profile, double centre_x, double centre_y,
                       const PixelEnergySettings& settings, ResponseGrid& grid);

/// Returns the largest radius, in px, at which `fill_pixel_energy` reads `profile`, the energy within each
/// radius. `centre_x` and `centre_y` are the centre of the impulse response.
[[nodiscard]] double reach_px(const ResponseGrid& grid, double centre_x, double centre_y,
                              const PixelEnergySettings& settings);

}  // namespace postlens
