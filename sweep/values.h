// Parses lists and ranges in the command-line options of a sweep.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Largest number of values in a list or a range, and largest number of images in a sweep.
inline constexpr std::size_t most_pictures = 10000;

/// Each of these functions parses a list of the form "ITEM,ITEM,...". An item is a value or a range, and no
/// value may occur twice. Error(wrong_arguments) is thrown if the text has another form, if a range is empty
/// or if there are too many values. The error message begins with `option`.

/// Parses f-numbers, which are positive numbers or `inf` for the pinhole. A range is written FROM:TO:STEP.
/// STEP is positive and in stops ("1/2" or "0.5"), and FROM must not exceed TO. Value i is FROM * 2^(i STEP /
/// 2), so values differ slightly from the rounded numbers engraved on lenses. The last value may exceed TO by
/// a tenth of a stop, or by half a step if that is less. For example, the range 2:11:1 ends at 11.31.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Parses focus distances s in metres, which are positive numbers or `inf`. A range is written FROM:TO:COUNT
/// and may rise or fall. COUNT is 2 or more and includes both ends. The values are evenly spaced in 1/s, so
/// the CoC (circle of confusion) of a fixed point changes in equal steps.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Parses focal lengths in mm, which are finite positive numbers. A range is written FROM:TO:COUNT and may
/// rise or fall. COUNT is 2 or more and includes both ends. The logarithms of the values are evenly spaced.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// Parses shutters in the form OPEN:CLOSE. Both times are finite and in seconds, and OPEN must not be after
/// CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// Parses impulse responses in the form of `parse_impulse`. The wavelengths of "diffraction" are also
/// separated by commas. A comma therefore begins the next item only if it is followed by the name of a kind
/// of impulse response.
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
