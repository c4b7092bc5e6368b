// The lists and ranges of a sweep, as people type them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lens/impulse.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// More than these are refused: a list or a range by itself, and all combinations of several.
inline constexpr std::size_t most_pictures = 10000;

/// Every list is "ITEM,ITEM,...", an item a value or a range; no value twice. Throws Error(wrong_arguments)
/// that begins with `option` for anything else, for an empty range and for one of too many values.

/// f-numbers, more than 0, `inf` for the pinhole; ranges FROM:TO:STEP, STEP in stops ("1/2" or "0.5", more
/// than 0), FROM not above TO. Value i is FROM * 2^(i STEP / 2): exact powers of what is asked for, where the
/// numbers engraved on lenses are rounded. TO counts as reached where it is missed by up to a tenth of a
/// stop or half a step, so that 2:11:1 ends at 11.31.
[[nodiscard]] std::vector<double> f_number_list(const std::string& option, std::string_view text);

/// Focus distances, m, more than 0, `inf` allowed; ranges FROM:TO:COUNT, COUNT 2 or more with both ends, in
/// either direction, evenly spaced in 1/s: the blur of what stands still then changes evenly.
[[nodiscard]] std::vector<double> focus_list(const std::string& option, std::string_view text);

/// Focal lengths, mm, finite and more than 0; ranges FROM:TO:COUNT as above, each longer by the same factor.
[[nodiscard]] std::vector<double> focal_length_list(const std::string& option, std::string_view text);

/// OPEN:CLOSE, s, finite, OPEN not after CLOSE.
[[nodiscard]] std::vector<TimeSpan> shutter_list(const std::string& option, std::string_view text);

/// What `parse_impulse` takes. A comma followed by the name of a kind begins the next: those within
/// diffraction's list of wavelengths do not.
[[nodiscard]] std::vector<Impulse> impulse_list(const std::string& option, std::string_view text);

}  // namespace postlens
