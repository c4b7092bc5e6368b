// i1 * i2 of [potmesil1983]: the raster of a moving thing, convolved with that of its path.
#pragma once

#include <optional>
#include <vector>

#include "motionblur/path_raster.h"

namespace postlens {

/// Planes of floats over a window of the raster of cells; each plane row by row, all 0 outside.
struct Planes {
    int x_begin = 0, y_begin = 0, width = 0, height = 0;
    std::vector<std::vector<float>> planes;
};

/// direct: a sum over the path's cells; runs of equal weight along a row or a column cost one step.
/// fft: by Fourier transforms, in blocks where that is cheaper.
/// automatic: the one that is predicted to be faster.
enum class ConvolutionMethod { automatic, direct, fft };

/// The sum over all cells c of i2 of weight(c) times i1 shifted by c. The output's window is the sum of the
/// two windows, or the part of it that lies in `wanted`; nothing else is computed. Values must be finite.
///
/// direct and fft agree within 1e-5 of the largest |value| of a plane: direct errs by at most 34 * 2^-24 of
/// what it adds up (float sums of 32 terms, added in double), fft by some 2^-22 of the plane's largest value,
/// also where the result is faint. Where no cell of i1 other than 0 reaches, both give 0; planes without
/// negative values get none. Same bits for any number of threads. `used`: the method taken.
/// Throws Error(out_of_memory).
[[nodiscard]] Planes convolve(const Planes& i1, const PathRaster& i2,
                              ConvolutionMethod method = ConvolutionMethod::automatic,
                              ConvolutionMethod* used = nullptr,
                              const std::optional<CellWindow>& wanted = std::nullopt);

/// From the definition, in double, cell by cell.
[[nodiscard]] Planes convolve_reference(const Planes& i1, const PathRaster& i2);

/// What `automatic` compares, s of one thread of the machine of docs/performance.md.
struct ConvolutionCosts {
    double direct_s = 0, fft_s = 0;
};
[[nodiscard]] ConvolutionCosts predict_costs(const Planes& i1, const PathRaster& i2,
                                             const std::optional<CellWindow>& wanted = std::nullopt);

}  // namespace postlens
