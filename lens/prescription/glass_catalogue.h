// A catalogue of the glasses that prescriptions refer to by name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "lens/prescription/glass.h"

namespace postlens {

/// Finds a glass by name, ignoring case, hyphens and a maker's suffix ("_SCHOTT"). An old name ("BK7") finds
/// the lead-free replacement ("N-BK7"). The result is empty if the name is unknown.
[[nodiscard]] std::optional<Glass> find_glass(std::string_view name);

/// Returns the published refractive index nd (at the d line) of a glass, to five decimals, or nothing if the
/// glass is unknown.
[[nodiscard]] std::optional<double> published_nd(std::string_view name);

/// Names of all glasses, in the makers' spelling.
[[nodiscard]] std::vector<std::string_view> glass_names();

}  // namespace postlens
