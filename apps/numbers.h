// Texts from the command line to numbers: the same rules for every option, in every locale.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "records/depth_encoding.h"
#include "records/image.h"

namespace postlens {

/// Which values an option takes, as help and messages say it.
struct OptionRange {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool includes_low = true;
    /// "more than 0", "1 or more", "0 to 8"; empty: all.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool hold(double value) const {
        return (includes_low ? value >= low : value > low) && value <= high;
    }
};
inline constexpr OptionRange any_value{}, above_0{.low = 0, .includes_low = false}, from_0{.low = 0};
inline constexpr OptionRange f_numbers = above_0, target_decibels{.low = 10, .high = 80},
                             wave_lengths_nm{.low = 100, .high = 1e5}, units_m{.low = 1e-9, .high = 1e9};

/// Throws Error(wrong_arguments) naming the option; `text` as it was typed.
void check_bounds(std::string_view option, double value, std::string_view text, const OptionRange& bounds);

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
/// "distance", "inverse" or "normalized:NEAR,FAR": two different distances of 0 or more.
[[nodiscard]] DepthEncoding parse_depth_encoding(std::string_view option, std::string_view text);
/// "forward.u,forward.v": two names, neither empty.
[[nodiscard]] std::pair<std::string, std::string> parse_names(std::string_view option, std::string_view text);

/// "1,4,16": whole numbers, one or more, at most 1000.
[[nodiscard]] std::vector<int> parse_whole_list(std::string_view option, std::string_view text);

/// "1 depth", "2 depths".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun);
/// A length in px to a tenth; what no film holds, with few digits.
[[nodiscard]] std::string px_text(double px);

/// "10,20,64,48": a part of a picture that begins within its first 2^31 pixels and has an area.
[[nodiscard]] Crop parse_crop(std::string_view option, std::string_view text);

/// Checks low < value <= high (low itself allowed with `including_low`). Throws Error(wrong_arguments).
double in_range(std::string_view option, double value, double low, bool including_low, const char* expected);

}  // namespace postlens
