// Texts from the command line to numbers: the same rules for every option, in every locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "records/image.h"

namespace postlens {

/// A finite number, or "inf" where `infinite` allows it. Throws Error(wrong_arguments) naming the option.
[[nodiscard]] double parse_number(std::string_view option, std::string_view text, bool infinite = false);
[[nodiscard]] int parse_whole(std::string_view option, std::string_view text);
/// "960x540".
[[nodiscard]] std::pair<int, int> parse_size(std::string_view option, std::string_view text);
/// "0:0.02": two finite numbers.
[[nodiscard]] std::pair<double, double> parse_span(std::string_view option, std::string_view text);
/// A whole number from 0 to 2^64 - 1.
[[nodiscard]] std::uint64_t parse_seed(std::string_view option, std::string_view text);
/// "12.5,34".
[[nodiscard]] std::pair<double, double> parse_position(std::string_view option, std::string_view text);

/// "2.5" (for both) or "2.5,-2.5": finite numbers.
[[nodiscard]] std::pair<double, double> parse_scale(std::string_view option, std::string_view text);
/// "forward.u,forward.v": two names, neither empty.
[[nodiscard]] std::pair<std::string, std::string> parse_names(std::string_view option, std::string_view text);

/// "1,4,16": whole numbers, one or more, at most 1000.
[[nodiscard]] std::vector<int> parse_whole_list(std::string_view option, std::string_view text);

/// "10,20,64,48": a part of a picture that begins within its first 2^31 pixels and has an area.
[[nodiscard]] Crop parse_crop(std::string_view option, std::string_view text);

/// Checks low < value <= high (low itself allowed with `including_low`). Throws Error(wrong_arguments).
double in_range(std::string_view option, double value, double low, bool including_low, const char* expected);

}  // namespace postlens
