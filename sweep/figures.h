// Values that a sweep measures and reports for each image.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "pictures/image.h"

namespace postlens {

/// The inverse depths in a sample file. They do not depend on the lens, so they are computed once for all
/// images of a sweep.
struct FrameDepths {
    int width = 0, height = 0;
    /// For each pixel: the inverse depth, in 1/m, of the surface that is seen at the pixel's upper left
    /// corner. The depth is measured along the optical axis. The value is 0 if the ray hit nothing.
    std::vector<float> inverse_z;
};
[[nodiscard]] FrameDepths frame_depths(FocusFrame& frame);

/// Returns the fraction (0 to 1) of pixels in focus: their circle of confusion is below `limit_px`. Without
/// `geometry` (an orthographic file has no lens), the fraction is 1.
[[nodiscard]] double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                                    double limit_px);

/// Measures an image's detail: the sum of squared differences of luminance (Rec.709, clamped to 0..1) between
/// each pixel and its right and lower neighbours. It is the same for any number of threads.
[[nodiscard]] double gradient_energy(const Image& image);

}  // namespace postlens
