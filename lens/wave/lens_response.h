// The response of a lens with its film at V: the picture of one point and its figures.
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
    /// Of geometric kinds; absent: made of `impulse`, which a picture cannot be.
    std::optional<Aperture> aperture;
    double wavelength_nm = 550;  ///< where the impulse names none
    int size_px = 0;  ///< of the square frame; 0: as large as holds 99% of the energy, 1025 at most
};

/// A place of the radial profile.
struct RadialSample {
    double radius_px = 0;
    double v = 0;  ///< of the mean wavelength
    double intensity =
        0;  ///< energy per area, 1 at the peak of the same lens in focus: I(u, v) of one wavelength
    double encircled = 0;  ///< share of the energy within the radius
};

struct LensResponse {
    /// Energy per pixel, of 1 in all: the frame's sum is `energy_in_frame`. The geometric image lies in the
    /// middle of the frame: of the middle pixel for odd sizes, of four pixels for even ones.
    ResponseGrid grid;
    double energy_in_frame = 0, peak_share = 0;
    double coc_px = 0;  ///< signed
    double image_distance_mm = 0;
    double wavelength_nm = 0;  ///< mean of those used
    double u = 0, v_per_px = 0;
    double airy_diameter_px = 0;  ///< to the first zero in focus, 2.4394 lambda V/D
    /// Twice the largest radius at which the intensity is half of the highest: of a disc its diameter. Absent
    /// where it lies beyond the frame.
    std::optional<double> fwhm_px;
    /// Of the circle that holds half of all energy: tells the blur where `fwhm_px` tells a bright fringe.
    /// Absent where it does not fit the frame.
    std::optional<double> half_energy_diameter_px;
    /// From 0 to the frame's half width, four places to a unit of v, 8192 at most, fewer where v reaches 1e6.
    std::vector<RadialSample> profile;
};

/// Throws Error(wrong_arguments) for F, n, s, depth, pitch, size and wavelengths out of range (n infinite is
/// a disc of no width, and no diffraction), Error(out_of_memory) with what it needs.
[[nodiscard]] LensResponse lens_response(const LensResponseRequest& request);

}  // namespace postlens
