// Computes a lens's impulse response, with its width, peak and radial profile.
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
    /// The aperture shape for impulse responses without diffraction. If it is absent, the aperture is made
    /// from the field `impulse`. If the aperture is an image, this field must be set, because `impulse`
    /// contains only the image's file name.
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
    /// Fraction of the energy in each pixel; the sum is `energy_in_frame`. The scene point's geometric image
    /// is at the centre of the grid. This is also the centre of a pixel if width and height are odd.
    ResponseGrid grid;
    double energy_in_frame = 0, peak_share = 0;
    double coc_px = 0;  ///< signed
    double image_distance_mm = 0;
    double wavelength_nm = 0;  ///< mean of the wavelengths used
    double u = 0, v_per_px = 0;
    double airy_diameter_px = 0;  ///< to the first zero in focus, 2.4394 lambda V/D
    /// Full width at half maximum: twice the largest radius at which the intensity is half its maximum.
    /// Absent if it exceeds the grid.
    std::optional<double> fwhm_px;
    /// Diameter of the circle that contains half of the energy. Unlike `fwhm_px`, it does not depend on
    /// single bright fringes. Absent if it exceeds the grid.
    std::optional<double> half_energy_diameter_px;
    /// Radial profile of the impulse response: samples of the intensity and of the encircled energy, at radii
    /// from 0 to half the grid's width. The radii are uniformly spaced, if possible with four samples per
    /// unit of the optical radius v. But there are always about 512 to 8192 samples.
    std::vector<RadialSample> profile;
};

/// Computes the impulse response of a lens for one scene point, as an image, as a radial profile, and as
/// characteristic diameters.
///
/// Throws Error(wrong_arguments) if a number is out of range, or if diffraction is requested for a pinhole.
/// Throws Error(out_of_memory), with the required memory.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
