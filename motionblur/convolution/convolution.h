// Convolution of the raster of a moving object with the raster of its path: i1 * i2 in [potmesil1983].
#pragma once

#include <optional>
#include <vector>

#include "motionblur/paths/path_raster.h"

namespace postlens {

/// Planes of floats over a window of the raster of cells. Each plane is stored row by row. Outside of the
/// window its values are 0.
struct Planes {
    int x_begin = 0, y_begin = 0, width = 0, height = 0;
    std::vector<std::vector<float>> planes;
};

/// Method of convolving an object's raster with the raster of its path.
/// - direct: a sum over the path's cells; a run of equal weights along a row or a column costs one step.
/// - fft: Fourier transforms, in blocks if blocks are cheaper.
/// - automatic: the method that is predicted to be faster.
enum class ConvolutionMethod { automatic, direct, fft };

/// Convolves i1, the raster of an object, with i2, the raster of its path. The result is the sum over all
/// cells c of i2 of weight(c) times i1 shifted by c. Its window is the sum of both windows. With `wanted`,
/// only the part within `wanted` is computed. Values must be finite.
///
/// The results of direct and fft agree within 1e-5 of the largest |value| of a plane. The error of direct is
/// at most 34 * 2^-24 of the sum of the terms (float sums of 32 terms, added in double). The error of fft is
/// about 2^-22 of the plane's largest value, even where the result is small. Both methods return 0 in cells
/// that no nonzero cell of i1 reaches. Both return no negative values for planes without negative values.
///
/// The result is bit-identical for any number of threads. `used` receives the method. Throws
/// Error(out_of_memory).
[[nodiscard]] Planes convolve(const Planes& i1, const PathRaster& i2,
                              ConvolutionMethod method = ConvolutionMethod::automatic,
                              ConvolutionMethod* used = nullptr,
                              const std::optional<CellWindow>& wanted = std::nullopt);

/// Convolves i1 with i2 directly from the definition, cell by cell, in double precision. For tests.
[[nodiscard]] Planes convolve_reference(const Planes& i1, const PathRaster& i2);

/// Predicted times of the methods direct and fft, s, for one thread of the machine of docs/performance.md.
/// The method `automatic` compares these times.
struct ConvolutionCosts {
    double direct_s = 0, fft_s = 0;
};
[[nodiscard]] ConvolutionCosts predict_costs(const Planes& i1, const PathRaster& i2,
                                             const std::optional<CellWindow>& wanted = std::nullopt);

}  // namespace postlens
