// Which pictures a sweep is made of: every combination of its settings, in order, each with its name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lens/impulse.h"
#include "tracer/ray_scene.h"

namespace postlens {

/// What varies. All but `shutters` need a value: except where the impulse responses are all of real lenses,
/// which have f-numbers of their own; these have focal lengths of their own, whatever is asked for.
struct SweepAxes {
    std::vector<Impulse> impulses{Impulse{}};
    std::vector<TimeSpan> shutters;  ///< empty: the frame's own instant
    std::vector<double> focal_lengths_mm;
    std::vector<double> f_numbers;  ///< infinity: pinhole
    std::vector<double> focus_m;
};

/// One picture.
struct SweepSetting {
    Impulse impulse;
    std::optional<TimeSpan> shutter;
    double focal_length_mm = 0, f_number = 0, focus_m = 0;
    std::string name;     ///< of its file, without an ending: "f1.4_s5"
    std::string caption;  ///< for people, ASCII, of what varies: "f/1.4  5 m"
};

struct SweepGrid {
    std::vector<SweepSetting> pictures;
    /// How many values the last axis with more than one has, the fastest: a row of the contact sheet.
    std::size_t row = 1;
};

/// All combinations: impulse responses slowest, then shutters, focal lengths, f-numbers, focus distances
/// fastest. Names have "f" and "s" always, "F", "t" and the impulse where they vary, with as many digits (4
/// or more) as tell the values of a list apart. Throws Error(wrong_arguments) for more than `most_pictures`
/// and for a list without values, and what reading a prescription throws.
[[nodiscard]] SweepGrid sweep_grid(const SweepAxes& axes);

/// "NAME.%04d" or "%d.exr" with the number `i` in place; nothing where there is not exactly one such place.
[[nodiscard]] std::optional<std::string> numbered_name(const std::string& pattern, std::size_t i);

}  // namespace postlens
