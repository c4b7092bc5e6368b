// Motion blur of another program's image, by its motion vectors.
#pragma once

#include "motionblur/motion_blur.h"
#include "motionblur/vectors/vector_frame.h"

namespace postlens {

struct VectorBlurSettings {
    Exposure exposure;  ///< in frames: 0 is the instant of the image, and 1 that of the next frame
    ShutterCurve curve = ShutterCurve::box();
    /// Number of instants, 1..most_views. If absent, the largest displacement determines it.
    std::optional<int> views;
    std::optional<Crop> crop;  ///< as in MotionBlurSettings
};

/// Blurs an image by its motion vectors. The result is the mean of views, which are reprojections of the
/// image to many instants. Every pixel moves along a straight line at its own constant velocity. Surfaces
/// that this motion uncovers are not in the image. They are filled from the pixels around them, with the
/// warning "uncovered".
///
/// If nothing moves, or if the exposure is the instant 0, the result is bit-identical to the image. The
/// result is bit-identical for any number of threads. Throws Error(wrong_arguments) for settings out of
/// range, and Error(out_of_memory).
[[nodiscard]] MotionBlurResult vector_blur(const VectorFrame& frame, const VectorBlurSettings& settings);

}  // namespace postlens
