// Values that a sweep measures and reports for each image.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "pictures/image.h"

namespace postlens {

/// The inverse depths of a frame. All images of the frame use them.
struct FrameDepths {
    int width = 0, height = 0;
    /// 1/z', 1/m, of the primary node (z': its path length along the optical axis) at each pixel's upper left
    /// corner. 0 if nothing was hit.
    std::vector<float> inverse_z;
};
[[nodiscard]] FrameDepths frame_depths(FocusFrame& frame);

/// Returns the fraction of the traced pixels, 0 to 1, whose circle of confusion has a diameter below
/// `limit_px`, in px of the image. An orthographic file has no lens and therefore no `geometry`; the fraction
/// is then 1.
[[nodiscard]] double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                                    double limit_px);

/// A measure of detail: the sum of the squared differences of luminance (Rec.709, clamped to 0..1) between
/// each pixel and its neighbours to the right and below. Deterministic for any number of threads.
[[nodiscard]] double gradient_energy(const Image& image);

}  // namespace postlens
