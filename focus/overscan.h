// Warning about pixels that lack light, because the light comes from surfaces beyond the recorded area.
#pragma once

#include <optional>

#include "focus/focus.h"
#include "focus/scatter/border_radii.h"

namespace postlens {

/// Returns a warning of code "overscan" if circles of confusion of the outermost records are wider than the
/// overscan. Light from beyond the records is then missing in the image pixels that these circles reach. If
/// `crop` is given, only the pixels of the image within it count. Returns nothing if no pixel is affected.
[[nodiscard]] std::optional<FocusWarning> overscan_warning(const BorderRadii& border,
                                                           const RasterWindow& source,
                                                           const RasterWindow& picture,
                                                           const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
