// Glasses that prescriptions call by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lens/prescription/glass.h"

namespace postlens {

/// The glass of that name, with or without a maker's suffix ("_SCHOTT"), hyphens or regard to case: "N-BK7",
/// "nbk7_schott" and "NBK7" are one. Sellmeier terms as the makers publish them. A name without its N-
/// ("BK7") is taken for the glass that replaced it. Empty where the name is not known.
[[nodiscard]] std::optional<Glass> find_glass(std::string_view name);

/// nd as it is published beside the terms, to five digits. Empty where the name is not known.
[[nodiscard]] std::optional<double> published_nd(std::string_view name);

/// All names, in the makers' spelling.
[[nodiscard]] std::vector<std::string_view> glass_names();

}  // namespace postlens
