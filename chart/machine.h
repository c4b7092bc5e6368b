// What a chart was measured on.
#pragma once

#include <nlohmann/json.hpp>

namespace postlens {

/// Processor, cores, threads in use, memory, compiler and the versions of the libraries that do the work.
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace postlens
