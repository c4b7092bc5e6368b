// Values that a sweep measures and reports for each image.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "pictures/image.h"

namespace postlens {

/// The inverse depths of a sample file. They apply to all images of a sweep, because lens and shutter do not
/// change them.
struct FrameDepths {
    int width = 0, height = 0;
    /// Inverse depth, in 1/m, of the directly visible surface at the upper left corner of each pixel. The
    /// depth is measured along the optical axis. The value is 0 if nothing was hit.
    std::vector<float> inverse_z;
};
[[nodiscard]] FrameDepths frame_depths(FocusFrame& frame);

/// Returns the fraction (0 to 1) of the traced pixels that are in focus. A pixel is in focus if its circle of
/// confusion has a diameter below `limit_px`, in px of the image. If `geometry` is absent, because an
/// orthographic file has no lens, the fraction is 1.
[[nodiscard]] double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                                    double limit_px);

/// Measures the detail of an image: the sum of the squared differences of luminance (Rec.709, clamped to
/// 0..1) between each pixel and its neighbours to the right and below. The result does not depend on the
/// number of threads.
[[nodiscard]] double gradient_energy(const Image& image);

}  // namespace postlens
