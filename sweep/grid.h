// The images of a sweep: every combination of its settings, in order, each with a name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Values of each setting that a sweep varies. All lists but `shutters` need a value. An exception is an
/// impulse response of a lens prescription: its focal length replaces `focal_lengths_mm`, and its f-number is
/// used if `f_numbers` is empty.
struct SweepAxes {
    std::vector<Impulse> impulses{Impulse{}};
    std::vector<TimeSpan> shutters;  ///< empty: no motion blur
    std::vector<double> focal_lengths_mm;
    std::vector<double> f_numbers;  ///< infinity: pinhole
    std::vector<double> focus_m;
};

/// Settings of one image.
struct SweepSetting {
    Impulse impulse;
    std::optional<TimeSpan> shutter;
    double focal_length_mm = 0, f_number = 0, focus_m = 0;
    std::string name;     ///< file name without extension: "f1.4_s5"
    std::string caption;  ///< the varied settings, in ASCII: "f/1.4  5 m"
};

struct SweepGrid {
    std::vector<SweepSetting> pictures;
    /// Length of a row of the contact sheet: number of values of the fastest setting that varies.
    std::size_t row = 1;
};

/// All combinations of the settings. Impulse responses vary slowest, then shutters, focal lengths and
/// f-numbers; focus distances vary fastest. A name always has f-number "f" and focus distance "s". It has
/// focal length "F", shutter "t" and the impulse response only if these vary. Numbers have 4 digits, or as
/// many as make the values of a list distinct. Throws Error(wrong_arguments) for more than `most_pictures`
/// images and for a missing list, and the errors of reading a prescription.
[[nodiscard]] SweepGrid sweep_grid(const SweepAxes& axes);

/// Replaces the conversion in a pattern such as "NAME.%04d" or "%d.exr" by the number `i`. Empty if the
/// pattern does not have exactly one conversion.
[[nodiscard]] std::optional<std::string> numbered_name(const std::string& pattern, std::size_t i);

}  // namespace postlens
