// Computes a convolution as a sum over the path's cells.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Convolves the image of a moving object with the blur kernel. `task` contains references to the image and
/// to the kernel. The pixels of the blurred image in the window `task.out` are written to `result`, where
/// they must be 0 before the call.
void convolve_direct(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double direct_cost_s(const ConvolutionTask& task);

}  // namespace postlens
