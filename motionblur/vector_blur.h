// Motion blur of a picture of another program by its motion vectors.
#pragma once

#include "motionblur/motion_blur.h"
#include "motionblur/vector_frame.h"

namespace postlens {

struct VectorBlurSettings {
    Exposure exposure;  ///< in frames: 0 is the picture's own instant, 1 the next frame's
    ShutterCurve curve = ShutterCurve::box();
    std::optional<int> views;  ///< instants, 1..most_views; absent: by the longest way
    std::optional<Crop> crop;  ///< as in MotionBlurSettings
};

/// The light field over time, every pixel going straight on at its own speed. What it uncovers is not in the
/// picture: it is filled from around and warned of ("uncovered"). With nothing that moves, and for an
/// exposure at 0 alone, it is the picture, bit for bit. The same bits for any number of threads. Throws
/// Error(wrong_arguments) for settings out of range and Error(out_of_memory).
[[nodiscard]] MotionBlurResult vector_blur(const VectorFrame& frame, const VectorBlurSettings& settings);

}  // namespace postlens
