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
    /// Shape of the lens's aperture, for impulse responses without diffraction. If it is not set, the shape
    /// is derived from `impulse`. If the shape is an image, `aperture` must be set, because `impulse`
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
    /// Impulse response: the fraction of a scene point's energy that falls into each pixel. The sum is
    /// `energy_in_frame`, because the rest of the energy falls outside the grid. The point's geometric image
    /// is at the centre of the grid.
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
    /// Radial profile of the impulse response: the intensity and the encircled energy at uniformly spaced
    /// radii from 0 to half the grid's width. There are four radii for each unit of the optical radius v, but
    /// at least about 512 and at most about 8192.
    std::vector<RadialSample> profile;
};

/// Computes the impulse response of a lens for one scene point, as an image, as a radial profile, and as
/// characteristic diameters.
///
/// Throws Error(wrong_arguments) if a number is out of range, or if diffraction is requested for a pinhole.
/// Throws Error(out_of_memory), with the required memory.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
