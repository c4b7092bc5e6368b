// What a sweep says of each picture in numbers.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"
#include "records/image.h"

namespace postlens {

/// What is the same for all pictures of a file.
struct FrameDepths {
    int width = 0, height = 0;
    /// 1/z' of the primary node at each pixel's upper left corner, 1/m; 0 where nothing was hit.
    std::vector<float> inverse_z;
};
[[nodiscard]] FrameDepths frame_depths(FocusFrame& frame);

/// The share of the traced pixels whose circle of confusion is less than `limit_px` across, in px of the
/// picture. Without a geometry (an orthographic file, which no lens can have taken) all.
[[nodiscard]] double in_focus_share(const FrameDepths& depths, const std::optional<FocusGeometry>& geometry,
                                    double limit_px);

/// Sum of the squared differences of luminance (Rec.709, clamped to 0..1) from each pixel to the next on the
/// right and to the one below: how much detail there is. The same for any number of threads.
[[nodiscard]] double gradient_energy(const Image& image);

}  // namespace postlens
