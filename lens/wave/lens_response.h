// Impulse response of a lens with its film at distance V, and numbers that describe the response.
#pragma once

#include <optional>
#include <vector>

#include "lens/aperture.h"
#include "lens/impulse.h"
#include "lens/response_grid.h"
#include "lens/thin_lens.h"

namespace postlens {

struct LensResponseRequest {
    ThinLens lens;
    double focus_distance_m = 1, depth_m = 1;
    double pixel_pitch_mm = 0.01875;
    Impulse impulse;  ///< disc, polygon, picture or diffraction
    /// Aperture for geometric kinds of impulse. If absent, made from `impulse`; required for an aperture
    /// picture.
    std::optional<Aperture> aperture;
    double wavelength_nm = 550;  ///< used if the impulse states none
    int size_px = 0;             ///< width and height, px; 0: contains 99 % of the energy, at most 1025
};

/// A sample of the radial profile.
struct RadialSample {
    double radius_px = 0;
    double v = 0;          ///< radius in units of v at the mean wavelength
    double intensity = 0;  ///< energy per area, relative to the peak of the same lens in focus
    double encircled = 0;  ///< share of the energy within the radius
};

struct LensResponse {
    /// Energy per pixel, as a share of the total energy; the sum over the grid is `energy_in_frame`. The
    /// geometric image is at the centre of the grid: at the centre of a pixel for odd sizes, at a pixel
    /// corner for even sizes.
    ResponseGrid grid;
    double energy_in_frame = 0, peak_share = 0;
    double coc_px = 0;  ///< signed
    double image_distance_mm = 0;
    double wavelength_nm = 0;  ///< mean of those used
    double u = 0, v_per_px = 0;
    double airy_diameter_px = 0;  ///< to the first zero in focus, 2.4394 lambda V/D
    /// Full width at half maximum: twice the largest radius at which the intensity is half of its maximum.
    /// For a disc it is the diameter. Absent if it exceeds the grid.
    std::optional<double> fwhm_px;
    /// Diameter of the circle that contains half of the energy. Unlike `fwhm_px`, which may measure only a
    /// bright fringe, it always measures the blur. Absent if the circle exceeds the grid.
    std::optional<double> half_energy_diameter_px;
    /// From the centre to half the width of the grid. Four samples per unit of v, at most 8192; fewer if v
    /// reaches 1e6, because such samples are slow.
    std::vector<RadialSample> profile;
};

/// Computes the response. An infinite f-number gives a disc of width 0 and is rejected for diffraction.
/// Throws Error(wrong_arguments) if focal length, f-number, focus distance, depth, pitch, size or a
/// wavelength is out of range, and Error(out_of_memory) with the memory needed.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
