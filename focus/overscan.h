// Does the file hold what the lens brings into the picture from beyond its border?
#pragma once

#include <optional>

#include "focus/border_radii.h"
#include "focus/focus.h"

namespace postlens {

/// A warning of code "overscan" where circles of confusion along the outermost records are wider than the
/// recorded margin: the pixels within reach of what was not recorded are then normalised over what was.
/// Measured by the CoC found at the edge of the records, not by the largest in the picture. With a crop of
/// the picture: the share of its pixels, and nothing where it has none of them.
[[nodiscard]] std::optional<FocusWarning> overscan_warning(const BorderRadii& border,
                                                           const RasterWindow& source,
                                                           const RasterWindow& picture,
                                                           const std::optional<Crop>& crop = std::nullopt);

}  // namespace postlens
