// Formats numbers with their nouns and units, for messages.
#pragma once

#include <concepts>
#include <string>
#include <string_view>

#include "core/text.h"

namespace postlens {

/// A number with its noun: "1 depth", "2 depths".
template <std::integral Number>
[[nodiscard]] std::string counted(Number count, std::string_view noun) {
    return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

/// A size in MB (1e6 bytes): "0.0021 MB", "34 MB".
[[nodiscard]] inline std::string megabytes(double bytes) {
    return rough(bytes / 1e6) + " MB";
}

}  // namespace postlens
