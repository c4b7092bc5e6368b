// Computes a convolution by Fourier transforms.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Convolves the image of a moving object with its blur kernel by FFT. `task` contains references to both.
/// The pixels of the blurred image in the window `task.out` are written to `result`, where they must be 0
/// before the call.
void convolve_fft(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double fft_cost_s(const ConvolutionTask& task);

/// Returns the smallest product of powers of 2, 3, 5 and 7 that is at least n. n must be at least 1.
[[nodiscard]] int fast_fft_size(int n);

}  // namespace postlens
