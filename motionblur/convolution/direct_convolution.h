// Computes a convolution as a sum over the path's cells.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Writes the result for the cells of `task.out` into `result`. These cells must be 0 before the call.
void convolve_direct(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double direct_cost_s(const ConvolutionTask& task);

}  // namespace postlens
