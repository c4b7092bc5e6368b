// Warns if blur from surfaces outside the traced area would reach into the image.
#pragma once

#include <optional>

#include "focus/focus.h"
#include "focus/scatter/border_radii.h"

namespace postlens {

/// Returns a warning of code "overscan" if the image lacks light of surfaces outside the recorded area. This
/// is so if blur at the border of the recorded area reaches across the overscan (the pixels that are recorded
/// outside the image) into the image. With a `crop`, only pixels within it count.
[[nodiscard]] std::optional<FocusWarning> overscan_warning(const BorderRadii& border,
                                                           const RasterWindow& source,
                                                           const RasterWindow& picture,
                                                           const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
