// Parses lists and ranges in the command-line options of a sweep.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Largest number of values in a list, and of images in a sweep.
inline constexpr std::size_t most_pictures = 10000;

/// Each function parses "ITEM,ITEM,...", where an item is a value or a range. Throws Error(wrong_arguments),
/// with a message that begins with `option`, for anything else and for repeated values.

/// Parses f-numbers: positive numbers, or `inf` for the pinhole. A range is FROM:TO:STEP with STEP in stops
/// ("1/2" or "0.5").
///
/// The last value may exceed TO, because engraved f-numbers are rounded: 2:11:1 ends at 11.31. The excess is
/// at most a tenth of a stop, and at most half a step.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Parses focus distances in m, positive or `inf`. A range is FROM:TO:COUNT, rising or falling, with both
/// ends. Values are evenly spaced in 1/s.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Parses focal lengths in mm, finite and positive. A range is FROM:TO:COUNT, rising or falling, with both
/// ends. Values are evenly spaced in their logarithm.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// Parses shutters OPEN:CLOSE, finite times in s. OPEN must not be after CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// Parses impulse responses, separated by commas, as `parse_impulse` does. A comma may also separate
/// wavelengths. So it begins a new impulse response only if a kind, such as "disc", follows.
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
