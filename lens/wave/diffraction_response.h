// Impulse responses of the unfocused circular aperture on the pixel grid, for many depths at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lens/focus_geometry.h"
#include "lens/response_grid.h"
#include "lens/wave/pixel_energy.h"
#include "lens/wave/spectrum.h"

namespace postlens {

struct DiffractionSettings {
    Spectrum spectrum = channel_bands();
    double centre_x = 0, centre_y = 0;  ///< where the geometric image lies, px from the anchor
    /// The grid ends at the radius beyond which at most this share of the energy lies; > 0, < 1. The tail
    /// falls with 1/r only: 0.01 is reached 10 lambda V/D from the edge, 0.001 at 100.
    double tail = 0.01;
    double max_radius_px = 1024;  ///< the grid ends here at the latest, whatever the tail is
    /// true: what lies beyond the grid's end is dealt out in proportion to what lies within: the sum is 1.
    /// false: it is lost, and the sum is 1 - loss.
    bool fold_tail = true;
    PixelEnergySettings pixels;
};

/// The responses of the three channels at one depth. All three grids have the same window; pixels that lie
/// wholly beyond `radius_px` of the centre hold 0.
struct ChannelResponses {
    std::array<ResponseGrid, 3> channel;
    std::array<double, 3> loss{};  ///< share of the energy beyond the grid, before it was folded in
    double radius_px = 0;
};

/// For each signed CoC diameter (px, FocusGeometry::coc_diameter_px) its responses, in the order given. Only
/// the absolute value matters: without aberrations the light before and behind the focus is the same.
/// v_per_px(lambda) comes from the geometry, u = v_per_px coc / 2. An aperture of no width diffracts without
/// bounds: refused, as are CoCs that are not finite or beyond
/// `largest_u` and settings out of range: Error(wrong_arguments).
/// Error(out_of_memory) with what it needs where the tables do not fit. Runs the depths in parallel; the
/// same bits for any number of threads.
[[nodiscard]] std::vector<ChannelResponses> diffraction_responses(const FocusGeometry& geometry,
                                                                  std::span<const double> coc_diameters_px,
                                                                  const DiffractionSettings& settings);

/// The radius v beyond which at most `tail` of the energy lies, from the tail's form (2/pi) v/(v^2 - u^2),
/// which is too large at the edge: never less than the true radius minus a fringe.
[[nodiscard]] double radius_of_tail(double u, double tail);

}  // namespace postlens
