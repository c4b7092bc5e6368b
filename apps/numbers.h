// Parses numbers from the command line. All options follow the same rules, whatever the locale.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pictures/foreign/depth_encoding.h"
#include "pictures/image.h"

namespace postlens {

/// The range of values that an option accepts. `text` describes the range in help and error messages.
struct OptionRange {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool includes_low = true;
    /// Describes the range as text, such as "more than 0", "1 or more" or "0 to 8". Empty if every value is
    /// accepted.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool hold(double value) const {
        return (includes_low ? value >= low : value > low) && value <= high;
    }
};
inline constexpr OptionRange any_value{}, above_0{.low = 0, .includes_low = false}, from_0{.low = 0};
inline constexpr OptionRange f_numbers = above_0, target_decibels{.low = 10, .high = 80},
                             units_m{.low = 1e-9, .high = 1e9};

/// Throws Error(wrong_arguments) if `value` is out of range. The message names the option and quotes `text`,
/// as typed by the user.
void check_bounds(std::string_view option, double value, std::string_view text, const OptionRange& bounds);

/// Parses a finite number, or "inf" if `infinite` is set. This function and those below throw
/// Error(wrong_arguments), which names the option.
[[nodiscard]] double parse_number(std::string_view option, std::string_view text, bool infinite = false);
/// Parses an integer that fits into an int. `bounds` is only for the error message: the caller checks the
/// range with check_bounds.
[[nodiscard]] int parse_whole(std::string_view option, std::string_view text,
                              const OptionRange& bounds = any_value);
/// Parses a size in px, such as "960x540".
[[nodiscard]] std::pair<int, int> parse_size(std::string_view option, std::string_view text);
/// Parses two finite numbers such as "0:0.02".
[[nodiscard]] std::pair<double, double> parse_span(std::string_view option, std::string_view text);
/// Parses an integer from 0 to 2^64 - 1.
[[nodiscard]] std::uint64_t parse_seed(std::string_view option, std::string_view text);
/// Parses a raster position in px, such as "12.5,34".
[[nodiscard]] std::pair<double, double> parse_position(std::string_view option, std::string_view text);

/// Parses two finite numbers such as "2.5,-2.5". A single number such as "2.5" is used for both.
[[nodiscard]] std::pair<double, double> parse_scale(std::string_view option, std::string_view text);
/// Parses a depth encoding: "distance", "inverse" or "normalized:NEAR,FAR". NEAR and FAR must be different
/// distances of 0 or more.
[[nodiscard]] DepthEncoding parse_depth_encoding(std::string_view option, std::string_view text);
/// Parses two nonempty names such as "forward.u,forward.v".
[[nodiscard]] std::pair<std::string, std::string> parse_names(std::string_view option, std::string_view text);

/// Parses 1 to 1000 integers such as "1,4,16".
[[nodiscard]] std::vector<int> parse_whole_list(std::string_view option, std::string_view text);

/// Formats a length in px: rounded to 0.1 px, or to three significant digits from 1e7 px on.
[[nodiscard]] std::string px_text(double px);

/// Parses a crop X,Y,W,H in px, such as "10,20,64,48". X and Y must be below 2^31, and W and H at least 1.
[[nodiscard]] Crop parse_crop(std::string_view option, std::string_view text);

/// Returns `value` if it exceeds `low`, or equals it and `including_low` is set. Otherwise, throws
/// Error(wrong_arguments).
double in_range(std::string_view option, double value, double low, bool including_low, const char* expected);

}  // namespace postlens
