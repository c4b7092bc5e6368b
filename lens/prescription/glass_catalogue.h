// A catalogue of the glasses that prescriptions refer to by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lens/prescription/glass.h"

namespace postlens {

/// Finds a glass by name. Case, hyphens and a maker's suffix ("_SCHOTT") are ignored, so "N-BK7",
/// "nbk7_schott" and "NBK7" are the same glass. The name of an old glass ("BK7") finds the lead-free glass
/// that replaced it ("N-BK7"). The Sellmeier terms are those that the makers publish. The result is empty if
/// the name is unknown.
[[nodiscard]] std::optional<Glass> find_glass(std::string_view name);

/// Returns the index nd that the maker publishes with the Sellmeier terms, to five decimals. The result is
/// empty if the name is unknown.
[[nodiscard]] std::optional<double> published_nd(std::string_view name);

/// Names of all glasses, in the makers' spelling.
[[nodiscard]] std::vector<std::string_view> glass_names();

}  // namespace postlens
