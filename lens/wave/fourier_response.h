// The response of any aperture, with any aberrations, by Fourier optics.
#pragma once

#include <vector>

#include "lens/response_grid.h"
#include "lens/wave/pupil.h"
#include "lens/wave/wavefront.h"

namespace postlens {

/// An aperture at one depth and wavelength, on its pixels. The picture has the aperture's own orientation
/// behind the focus (u > 0) and is turned by half a turn before it.
struct FourierResponse {
    Transmission transmission = circular_aperture();
    Wavefront wavefront;
    double u = 0;                       ///< defocus, as in wave_scale.h
    double v_per_px = 1;                ///< > 0
    double centre_x = 0, centre_y = 0;  ///< where the geometric image lies, px from the grid's anchor
};

/// The grids of the transform, found before any memory is taken.
struct FourierSampling {
    int size = 0;            ///< N: fields are N x N
    double cells = 0;        ///< of the pupil to its radius
    double v_step = 0;       ///< of the field on the film
    int samples_per_px = 1;  ///< v_per_px / v_step, whole
    [[nodiscard]] double bytes() const;
};

/// Fields that alias nothing: on the film at most 1.1 in v between samples (the intensity has no frequency
/// above 2, or 2 sqrt(2) where the aperture reaches into the corners of its square), in the pupil at most a
/// quarter wave between neighbours at the steepest of defocus and aberrations and at least 96 cells to the
/// radius, and around the window as far again as light goes. N has the factors 2, 3, 5 only.
/// Throws Error(wrong_arguments) for numbers out of range.
[[nodiscard]] FourierSampling fourier_sampling(const FourierResponse& response, const ResponseGrid& window);

/// The field on the film.
struct FourierField {
    /// |amplitude|^2, N x N, (0, 0) first and wrapped: I(u, v), 1 where all of the unit disc interferes.
    std::vector<double> intensity;
    double light = 0;  ///< what passes: pi for the open disc
};

/// Throws Error(out_of_memory) with what it needs, Error(wrong_arguments) where no light passes.
[[nodiscard]] FourierField fourier_field(const FourierResponse& response, const FourierSampling& sampling);

/// Fills the grid with the energy in each pixel, of 1 through the aperture. The pixel's square is applied to
/// the transfer function, which is exact for the sampled field. What lies beyond the grid is not in it.
/// Throws as the two above.
void fill_fourier_energy(const FourierResponse& response, ResponseGrid& grid);

}  // namespace postlens
