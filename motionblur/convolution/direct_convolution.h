// Computes a convolution as a sum over the path's cells.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Adds the result for `task.out` to `result`, whose planes are 0 there.
void convolve_direct(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double direct_cost_s(const ConvolutionTask& task);

}  // namespace postlens
