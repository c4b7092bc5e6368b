// Warns if blur from surfaces outside the traced area would reach into the image.
#pragma once

#include <optional>

#include "focus/focus.h"
#include "focus/scatter/border_radii.h"

namespace postlens {

/// Returns a warning of code "overscan" if the blur at the border of the traced area reaches across the
/// overscan, the margin around the image, into the image. Light from outside is then missing in the image.
/// With a `crop`, only pixels within it count.
[[nodiscard]] std::optional<FocusWarning> overscan_warning(const BorderRadii& border,
                                                           const RasterWindow& source,
                                                           const RasterWindow& picture,
                                                           const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
