// Computes a convolution as a sum over the path's cells.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Writes the convolution of `task` (an object's image with its path) into the cells `task.out` of `result`.
/// These cells must be 0 before the call.
void convolve_direct(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double direct_cost_s(const ConvolutionTask& task);

}  // namespace postlens
