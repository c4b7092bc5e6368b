// Parses lists and ranges in the command-line options of a sweep.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Largest number of values that a list of settings, such as f-numbers, may have. It is also the largest
/// number of images in a sweep.
inline constexpr std::size_t most_pictures = 10000;

/// Each function parses "ITEM,ITEM,...", where an item is a value or a range. Throws Error(wrong_arguments),
/// with a message that begins with `option`, for anything else and for repeated values.

/// Parses f-numbers, which are positive numbers or `inf` for the pinhole. A range is written as FROM:TO:STEP,
/// where STEP is in stops, for example "1/2" or "0.5".
///
/// The last value may exceed TO by at most a tenth of a stop and at most half a step, because the f-numbers
/// engraved on a lens are rounded. For example, 2:11:1 ends at 11.31.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Parses focus distances s in m, which are positive numbers or `inf`. A range is written as FROM:TO:COUNT.
/// It may rise or fall, and includes both ends. Its COUNT values are evenly spaced in 1/s, because the blur
/// changes almost linearly with 1/s.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Parses focal lengths in mm, finite and positive. A range is FROM:TO:COUNT, rising or falling, with both
/// ends. Values are evenly spaced in their logarithm.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// Parses shutters OPEN:CLOSE, finite times in s. OPEN must not be after CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// Parses a list of impulse responses, which are separated by commas. Each of them is parsed by
/// `parse_impulse`. The wavelengths of one impulse response may be separated by commas too. Therefore, a
/// comma begins a new impulse response only if a kind follows, such as "disc".
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
