// Convolution by Fourier transforms.
#pragma once

#include "motionblur/convolution_task.h"

namespace postlens {

/// Writes the result for `task.out` into `result`, whose planes are 0 elsewhere.
void convolve_fft(const ConvolutionTask& task, Planes& result);

/// Predicted time of one thread, s.
[[nodiscard]] double fft_cost_s(const ConvolutionTask& task);

/// The least product of powers of 2, 3, 5 and 7 that is not less than n (1 or more).
[[nodiscard]] int fast_fft_size(int n);

}  // namespace postlens
