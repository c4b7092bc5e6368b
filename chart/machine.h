// Describes the machine on which a chart is measured.
#pragma once

#include <nlohmann/json.hpp>

namespace postlens {

/// Returns the processor, cores, threads, memory, compiler and library versions.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace postlens
