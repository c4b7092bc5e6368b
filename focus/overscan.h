// Warning about pixels that lack light from surfaces beyond the recorded area.
#pragma once

#include <optional>

#include "focus/focus.h"
#include "focus/scatter/border_radii.h"

namespace postlens {

/// Returns a warning of code "overscan" if circles of confusion at the border are wider than the overscan.
/// The image then lacks light from beyond. With a `crop`, only its pixels count.
[[nodiscard]] std::optional<FocusWarning> overscan_warning(const BorderRadii& border,
                                                           const RasterWindow& source,
                                                           const RasterWindow& picture,
                                                           const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
