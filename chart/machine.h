// Describes the machine on which a chart is measured.
#pragma once

#include <nlohmann/json.hpp>

namespace postlens {

/// Returns the processor, its cores, the threads in use, the memory, the compiler, and the versions of the
/// main libraries.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace postlens
