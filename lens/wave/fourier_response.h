// Impulse response of any aperture, with any aberrations, by Fourier optics.
#pragma once

#include <vector>

#include "lens/response_grid.h"
#include "lens/wave/pupil.h"
#include "lens/wave/wavefront.h"

namespace postlens {

/// An aperture at one depth and wavelength, and the position of its pixels. The response has the orientation
/// of the aperture behind the focus (u > 0) and is rotated by 180 degrees in front of it.
struct FourierResponse {
    Transmission transmission = circular_aperture();
    Wavefront wavefront;
    double u = 0;                       ///< defocus, as in wave_scale.h
    double v_per_px = 1;                ///< > 0
    double centre_x = 0, centre_y = 0;  ///< geometric image, px from the grid's anchor
};

/// Sizes of the transform's grids, computed before any memory is allocated.
struct FourierSampling {
    int size = 0;            ///< N: fields are N x N
    double cells = 0;        ///< cells of the pupil per radius
    double v_step = 0;       ///< sample spacing of the field on the film
    int samples_per_px = 1;  ///< v_per_px / v_step, an integer
    [[nodiscard]] double bytes() const;
};

/// Chooses sizes without aliasing. On the film, samples are at most 1.1 apart in v: the intensity has no
/// frequency above 2, or 2 sqrt(2) if the aperture reaches into the corners of its square. In the pupil,
/// neighbouring cells differ by at most a quarter wave at the steepest phase, and a radius has at least 96
/// cells. The field extends beyond the window as far as light does. N has the factors 2, 3 and 5 only. Throws
/// Error(wrong_arguments) for numbers out of range.
[[nodiscard]] FourierSampling fourier_sampling(const FourierResponse& response, const ResponseGrid& window);

/// The field on the film.
struct FourierField {
    /// |amplitude|^2 = I(u, v), N x N, periodic with v = (0, 0) first; 1 where the whole unit disc interferes
    /// constructively.
    std::vector<double> intensity;
    double light = 0;  ///< transmission integrated over the aperture: pi for the open disc
};

/// Throws Error(out_of_memory), with the memory needed, and Error(wrong_arguments) if no light passes.
[[nodiscard]] FourierField fourier_field(const FourierResponse& response, const FourierSampling& sampling);

/// Fills the grid with the energy in each pixel; the energy through the aperture is 1. The transfer function
/// is multiplied by the transform of the pixel's square, which is exact for the sampled field. Energy beyond
/// the grid is lost. Throws the errors of fourier_sampling and fourier_field.
void fill_fourier_energy(const FourierResponse& response, ResponseGrid& grid);

}  // namespace postlens
