// Motion blur of another program's image, by its motion vectors.
#pragma once

#include "motionblur/motion_blur.h"
#include "motionblur/vectors/vector_frame.h"

namespace postlens {

struct VectorBlurSettings {
    Exposure exposure;  ///< in frames: 0 is the instant of the image, and 1 that of the next frame
    ShutterCurve curve = ShutterCurve::box();
    /// Number of instants whose images are averaged, 1..most_views. If absent, the largest displacement
    /// determines it.
    std::optional<int> views;
    std::optional<Crop> crop;  ///< as in MotionBlurSettings
};

/// Blurs an image by its motion vectors. Gaps that moving objects uncover are filled from the pixels around
/// them, and the warning "uncovered" is added to the result.
///
/// The result is bit-identical for any number of threads. If nothing moves, it equals the image. Throws
/// Error(wrong_arguments) and Error(out_of_memory).
[[nodiscard]] MotionBlurResult vector_blur(const VectorFrame& frame, const VectorBlurSettings& settings);

}  // namespace postlens
