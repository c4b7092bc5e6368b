// Figures that a sweep reports for each image.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "pictures/image.h"

namespace postlens {

/// Inverse depths of a frame, which all images of the frame share.
struct FrameDepths {
    int width = 0, height = 0;
    /// 1/z' of the primary node at each pixel's upper left corner, 1/m; 0 if nothing was hit.
    std::vector<float> inverse_z;
};
[[nodiscard]] FrameDepths frame_depths(FocusFrame& frame);

/// Share of the traced pixels, 0 to 1, whose circle of confusion has a diameter below `limit_px`, in px of
/// the image. An orthographic file has no lens and therefore no `geometry`; the result is then 1.
[[nodiscard]] double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                                    double limit_px);

/// Measure of detail: sum of the squared differences of luminance (Rec.709, clamped to 0..1) between each
/// pixel and its neighbours to the right and below. Deterministic for any number of threads.
[[nodiscard]] double gradient_energy(const Image& image);

}  // namespace postlens
