// Catalogue of glasses that prescriptions refer to by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lens/prescription/glass.h"

namespace postlens {

/// Finds a glass by name. A maker's suffix ("_SCHOTT"), hyphens and case are ignored: "N-BK7", "nbk7_schott"
/// and "NBK7" are the same glass. The Sellmeier terms are those that the makers publish. A name without its
/// N- ("BK7") stands for the glass that replaced it. Empty if the name is unknown.
[[nodiscard]] std::optional<Glass> find_glass(std::string_view name);

/// nd as published with the terms, to five decimals. Empty if the name is unknown.
[[nodiscard]] std::optional<double> published_nd(std::string_view name);

/// Names of all glasses, in the makers' spelling.
[[nodiscard]] std::vector<std::string_view> glass_names();

}  // namespace postlens
