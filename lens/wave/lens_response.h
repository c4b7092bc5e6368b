// Impulse response of a lens with its film at V, and its figures.
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
    /// Aperture for geometric kinds; absent: made from `impulse`. Needed for a picture.
    std::optional<Aperture> aperture;
    double wavelength_nm = 550;  ///< used if the impulse states none
    int size_px = 0;  ///< of the square frame; 0: large enough for 99 % of the energy, at most 1025
};

/// A sample of the radial profile.
struct RadialSample {
    double radius_px = 0;
    double v = 0;  ///< radius in units of v at the mean wavelength
    double intensity =
        0;  ///< energy per area, 1 at the peak of the same lens in focus; I(u, v) for one wavelength
    double encircled = 0;  ///< share of the energy within the radius
};

struct LensResponse {
    /// Energy per pixel, of a total of 1; the sum over the frame is `energy_in_frame`. The geometric image is
    /// at the centre of the frame: the centre of a pixel for odd sizes, a pixel corner for even sizes.
    ResponseGrid grid;
    double energy_in_frame = 0, peak_share = 0;
    double coc_px = 0;  ///< signed
    double image_distance_mm = 0;
    double wavelength_nm = 0;  ///< mean of those used
    double u = 0, v_per_px = 0;
    double airy_diameter_px = 0;  ///< to the first zero in focus, 2.4394 lambda V/D
    /// Twice the largest radius at which the intensity is half of its maximum; the diameter of a disc. Absent
    /// if it is beyond the frame.
    std::optional<double> fwhm_px;
    /// Diameter of the circle that holds half of the energy. It measures the blur even where `fwhm_px`
    /// measures only a bright fringe. Absent if the circle does not fit the frame.
    std::optional<double> half_energy_diameter_px;
    /// From 0 to half the width of the frame: four samples per unit of v, at most 8192, and fewer if v
    /// reaches 1e6.
    std::vector<RadialSample> profile;
};

/// An infinite n gives a disc of width 0 and is refused for diffraction. Throws Error(wrong_arguments) if F,
/// n, s, depth, pitch, size or wavelengths are out of range, Error(out_of_memory) with the memory needed.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
