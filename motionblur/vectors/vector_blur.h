// Motion blur of another program's image, using its motion vectors.
#pragma once

#include "motionblur/motion_blur.h"
#include "motionblur/vectors/vector_frame.h"

namespace postlens {

struct VectorBlurSettings {
    Exposure exposure;  ///< in frames: 0 is the instant of the image, 1 that of the next frame
    ShutterCurve curve = ShutterCurve::box();
    std::optional<int> views;  ///< number of instants, 1..most_views; absent: from the longest displacement
    std::optional<Crop> crop;  ///< as in MotionBlurSettings
};

/// Blurs an image by its motion vectors: averages views (reprojections of the image) at many instants. Every
/// pixel moves along a straight line at its own constant velocity. Surfaces that this motion uncovers are not
/// in the image; they are filled from the pixels around them, with the warning "uncovered". If nothing moves,
/// or if the exposure is the instant 0, the result is bit-identical to the image. For any number of threads,
/// results are bit-identical. Throws Error(wrong_arguments) for settings out of range, and
/// Error(out_of_memory).
[[nodiscard]] MotionBlurResult vector_blur(const VectorFrame& frame, const VectorBlurSettings& settings);

}  // namespace postlens
