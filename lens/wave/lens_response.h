// Computes the impulse response of a lens, with its width, its peak and its radial profile.
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
    /// The aperture, for impulse responses without diffraction. It is required if `impulse` is an aperture
    /// image. Otherwise, if absent, it is made from `impulse`.
    std::optional<Aperture> aperture;
    double wavelength_nm = 550;  ///< used if the impulse states none
    int size_px = 0;             ///< width and height; 0: wide enough for 99 % of the energy, up to 1025
};

/// A sample of the radial profile.
struct RadialSample {
    double radius_px = 0;
    double v = 0;          ///< radius in units of v at the mean wavelength
    double intensity = 0;  ///< energy per area, relative to the peak of the same lens in focus
    double encircled = 0;  ///< fraction of the energy within the radius
};

struct LensResponse {
    /// The energy in each pixel, as a fraction of the total energy. The sum over the grid is
    /// `energy_in_frame`. The geometric image of the scene point is at the centre of the grid, which is the
    /// centre of a pixel for odd sizes and a pixel corner for even sizes.
    ResponseGrid grid;
    double energy_in_frame = 0, peak_share = 0;
    double coc_px = 0;  ///< signed
    double image_distance_mm = 0;
    double wavelength_nm = 0;  ///< mean of the wavelengths used
    double u = 0, v_per_px = 0;
    double airy_diameter_px = 0;  ///< to the first zero in focus, 2.4394 lambda V/D
    /// Full width at half maximum, which is twice the largest radius at which the intensity is half of its
    /// maximum. For a disc, it is the diameter. Absent if it exceeds the grid.
    std::optional<double> fwhm_px;
    /// Diameter of the circle that contains half of the energy. It measures the whole blur, whereas `fwhm_px`
    /// may measure only a bright fringe. Absent if the circle exceeds the grid.
    std::optional<double> half_energy_diameter_px;
    /// Evenly spaced samples of the radial profile, from the centre to half the width of the grid. There are
    /// four samples per unit of v (the optical radius), but at least 512 and at most 8192. The maximum is
    /// lower if the samples would take more than a few seconds to compute.
    std::vector<RadialSample> profile;
};

/// Computes the impulse response of a lens for one scene point. A pinhole (infinite f-number) images the
/// point as a point. Throws Error(wrong_arguments) if a number of the request is out of range, or if
/// diffraction is requested for a pinhole. Throws Error(out_of_memory), with the required memory, if memory
/// is short.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
