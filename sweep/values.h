// Parses lists and ranges in the command-line options of a sweep.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Greatest number of values in a list or a range, and greatest number of combinations.
inline constexpr std::size_t most_pictures = 10000;

/// Every list has the form "ITEM,ITEM,...". An item is a value or a range, and no value may occur twice. Each
/// function throws Error(wrong_arguments) for any other text, for an empty range and for too many values; the
/// message begins with `option`.

/// Parses f-numbers: positive numbers, or `inf` for the pinhole. Ranges are FROM:TO:STEP with a positive STEP
/// in stops ("1/2" or "0.5") and FROM not above TO. Value i is FROM * 2^(i STEP / 2), which differs from the
/// rounded numbers engraved on lenses. The last value may exceed TO by a tenth of a stop or half a step,
/// whichever is less. The range 2:11:1 therefore ends at 11.31.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Parses focus distances s, m: positive numbers, or `inf`. Ranges are FROM:TO:COUNT, rising or falling, with
/// a COUNT of 2 or more that includes both ends. The values are uniformly spaced in 1/s, so that the CoC of a
/// fixed point changes in equal steps.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Parses focal lengths, mm: finite positive numbers. Ranges are FROM:TO:COUNT, rising or falling, with a
/// COUNT of 2 or more that includes both ends. The logarithms of the values are uniformly spaced.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// Shutters OPEN:CLOSE, s: finite, OPEN not after CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// Parses impulse responses in the form of `parse_impulse`. A comma begins the next item only if the name of
/// a kind follows, because the list of wavelengths of "diffraction" also contains commas.
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
