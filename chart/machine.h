// Description of the machine on which a chart is measured.
#pragma once

#include <nlohmann/json.hpp>

namespace postlens {

/// Processor, cores, threads in use, memory, compiler, and the versions of the main libraries.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace postlens
