// Blurs a moving object by convolving its image with the image of its path [potmesil1983].
#pragma once

#include <optional>
#include <vector>

#include "motionblur/paths/path_raster.h"

namespace postlens {

/// Several planes of floats over a window of the raster, row by row. All values outside the window are 0.
struct Planes {
    int x_begin = 0, y_begin = 0, width = 0, height = 0;
    std::vector<std::vector<float>> planes;
};

/// Method of convolving the image of an object with the image of its motion path.
/// - direct: sums over the pixels of the path's image.
/// - fft: multiplies Fourier transforms.
/// - automatic: the method with the shorter predicted time.
enum class ConvolutionMethod { automatic, direct, fft };

/// Convolves i1, the raster of an object, with i2, the raster of its path: each cell c of i2 adds a copy of
/// i1, shifted by c and times weight(c). Values must be finite. With `wanted`, only the part within this
/// window is computed. `used` receives the method.
///
/// The two methods agree within 1e-5 of a plane's largest |value|. The error of direct is at most 34 * 2^-24
/// of the sum of the terms, and that of fft about 2^-22 of the plane's largest value. Cells that no nonzero
/// cell of i1 reaches are exactly 0. Planes without negative values keep none.
///
/// The result is bit-identical for any number of threads. Throws Error(out_of_memory).
[[nodiscard]] Planes convolve(const Planes& i1, const PathRaster& i2,
                              ConvolutionMethod method = ConvolutionMethod::automatic,
                              ConvolutionMethod* used = nullptr,
                              const std::optional<CellWindow>& wanted = std::nullopt);

/// Slow reference of `convolve` for tests. For each cell of the blur kernel `i2`, adds a copy of the image
/// `i1` that is shifted by the cell's position and multiplied by its weight. Computes in double precision.
[[nodiscard]] Planes convolve_reference(const Planes& i1, const PathRaster& i2);

/// Predicted times of direct convolution and of FFT convolution on one thread, in seconds, for the computer
/// described in docs/performance.md.
struct ConvolutionCosts {
    double direct_s = 0, fft_s = 0;
};
[[nodiscard]] ConvolutionCosts predict_costs(const Planes& i1, const PathRaster& i2,
                                             const std::optional<CellWindow>& wanted = std::nullopt);

}  // namespace postlens
