// Computes a convolution as a sum over the path's cells.
#pragma once

#include "motionblur/convolution/convolution_task.h"

namespace postlens {

/// Convolves the image of a moving object with the blur kernel, which is an image of the object's motion
/// path. `task` refers to both. The blurred image is written to the cells `task.out` of `result`, which must
/// be 0 before the call.
void convolve_direct(const ConvolutionTask& task, Planes& result);

/// Returns the predicted time of one thread, in seconds.
[[nodiscard]] double direct_cost_s(const ConvolutionTask& task);

}  // namespace postlens
