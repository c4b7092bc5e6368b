// Convolution by Fourier transforms.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Writes the result for `task.out` into `result`, whose planes are 0 everywhere else.
void convolve_fft(const ConvolutionTask& task, Planes& result);

/// Predicted time of one thread, s.
[[nodiscard]] double fft_cost_s(const ConvolutionTask& task);

/// Smallest product of powers of 2, 3, 5 and 7 that is at least n (n >= 1).
[[nodiscard]] int fast_fft_size(int n);

}  // namespace postlens
