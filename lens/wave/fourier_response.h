// Impulse response of any aperture with any aberrations, computed by Fourier optics.
#pragma once

#include <vector>

#include "lens/response_grid.h"
#include "lens/wave/pupil.h"
#include "lens/wave/wavefront.h"

namespace postlens {

/// An aperture at one depth and wavelength, and the position of the response on the pixel grid. Behind the
/// focus (u > 0) the response has the orientation of the aperture; in front of the focus it is rotated by 180
/// degrees.
struct FourierResponse {
    Transmission transmission = circular_aperture();
    Wavefront wavefront;
    double u = 0;                       ///< defocus, as in wave_scale.h
    double v_per_px = 1;                ///< > 0
    double centre_x = 0, centre_y = 0;  ///< geometric image, px from the grid's anchor
};

/// Sizes of the Fourier transform's grids, computed before any memory is allocated.
struct FourierSampling {
    int size = 0;            ///< N: fields are N x N
    double cells = 0;        ///< number of pupil cells per pupil radius
    double v_step = 0;       ///< sample spacing of the field on the film
    int samples_per_px = 1;  ///< v_per_px / v_step, an integer
    [[nodiscard]] double bytes() const;
};

/// Chooses grid sizes that avoid aliasing. On the film, samples are at most 1.1 apart in v. This suffices
/// because the intensity has no frequency above 2, or 2 sqrt(2) if the aperture reaches the corners of its
/// square. In the pupil, the phase of neighbouring cells differs by at most a quarter wave, and a radius has
/// at least 96 cells. The field is wide enough to contain all light. N has only the factors 2, 3 and 5.
/// Throws Error(wrong_arguments) for numbers out of range.
[[nodiscard]] FourierSampling fourier_sampling(const FourierResponse& response, const ResponseGrid& window);

/// The field on the film.
struct FourierField {
    /// |amplitude|^2 = I(u, v), N x N, periodic, with v = (0, 0) first. The value 1 means that light from the
    /// whole unit disc interferes constructively.
    std::vector<double> intensity;
    double light = 0;  ///< transmission integrated over the aperture: pi for the open disc
};

/// Computes the field. Throws Error(out_of_memory), with the memory needed, and Error(wrong_arguments) if no
/// light passes.
[[nodiscard]] FourierField fourier_field(const FourierResponse& response, const FourierSampling& sampling);

/// Fills the grid with the energy in each pixel; the total energy through the aperture is 1. The transform of
/// the intensity is multiplied by the transform of the pixel's square, which integrates the sampled field
/// exactly. Energy beyond the grid is lost. Throws the errors of fourier_sampling and fourier_field.
void fill_fourier_energy(const FourierResponse& response, ResponseGrid& grid);

}  // namespace postlens
