// Computes impulse responses of a circular aperture with diffraction, for many depths at once.
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
    double centre_x = 0, centre_y = 0;  ///< point's geometric image, px from the response's raster position
    /// Largest fraction, between 0 and 1, of an impulse response's energy that may lie beyond the edge of its
    /// pixel grid. The size of the grid is chosen accordingly. The fraction beyond the edge decreases only as
    /// 1 / (radius of the grid), so small fractions need large grids.
    double tail = 0.01;
    double max_radius_px = 1024;  ///< largest radius of the grid, for any tail
    /// If true, the energy that falls beyond the edge of the pixel grid is added to the pixels of the grid,
    /// in proportion to their values. Therefore, the values sum to 1. If false, this energy is lost.
    bool fold_tail = true;
    PixelEnergySettings pixels;
};

/// The impulse responses of the three colour channels at one depth, on the same pixels. Pixels outside the
/// circle of `radius_px` are 0.
struct ChannelResponses {
    std::array<ResponseGrid, 3> channel;
    std::array<double, 3> loss{};  ///< fraction of the energy beyond the grid, even with fold_tail
    double radius_px = 0;
};

/// Computes the impulse responses to points of different defocus: one for each diameter of the circle of
/// confusion (CoC), in px. The diameter is positive behind the focus distance. Results are bit-identical for
/// any number of threads.
///
/// Throws Error(wrong_arguments) for an aperture of width 0, a setting out of range, or a CoC whose defocus
/// in optical units exceeds `largest_u`. Throws Error(out_of_memory), with the required memory.
[[nodiscard]] std::vector<ChannelResponses> diffraction_responses(const FocusGeometry& geometry,
                                                                  std::span<const double> coc_diameters_px,
                                                                  const DiffractionSettings& settings);

/// Estimates the radius v of the circle outside which the fraction `tail` of a diffraction pattern's energy
/// lies, at the defocus u. v and u are in optical units [born1999, 8.8.1]. Solves (2/pi) v / (v^2 - u^2) =
/// tail.
///
/// The true radius may be larger by the width of one diffraction fringe. Close to |u|, the edge of the blur
/// disc, the estimate is too large.
[[nodiscard]] double radius_of_tail(double u, double tail);

}  // namespace postlens
