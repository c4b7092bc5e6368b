// Parses the lists and ranges of a sweep's command-line options.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Greatest number of values of a list or a range, and of all combinations.
inline constexpr std::size_t most_pictures = 10000;

/// Every list has the form "ITEM,ITEM,...", where an item is a value or a range and no value occurs twice.
/// Each function throws Error(wrong_arguments), whose text begins with `option`, for any other text, for an
/// empty range and for too many values.

/// f-numbers: positive, or `inf` for the pinhole. Ranges are FROM:TO:STEP with STEP in stops ("1/2" or "0.5",
/// positive) and FROM not above TO. Value i is FROM * 2^(i STEP / 2), not the rounded number that is engraved
/// on lenses. The last value may exceed TO by up to a tenth of a stop or half a step, whichever is less, so
/// that 2:11:1 ends at 11.31.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Focus distances s, m: positive, or `inf`. Ranges are FROM:TO:COUNT, rising or falling; COUNT is 2 or more
/// and includes both ends. The values are uniformly spaced in 1/s, so that the CoC of a fixed point changes
/// by equal steps.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Focal lengths, mm: finite and positive. Ranges are FROM:TO:COUNT, rising or falling; COUNT is 2 or more
/// and includes both ends. The values are uniformly spaced in their logarithm.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// Shutters OPEN:CLOSE, s: finite, OPEN not after CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// Impulse responses in the form of `parse_impulse`. A comma begins the next item only if the name of a kind
/// follows it, because diffraction's list of wavelengths contains commas as well.
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
