// A sweep makes an image for every combination of the given settings. Lists the combinations, and names the
// images.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lens/impulse.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// A sweep makes an image for each combination of lens settings. Each list contains the values of one
/// setting. Every list needs at least one value, except `shutters`. With a real lens (prescription),
/// `focal_lengths_mm` is not used, and `f_numbers` may be empty.
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
    /// Number of images in each row of the contact sheet, which shows thumbnails of all images. The images
    /// are combinations of settings, made in nested loops. The number is that of the values in the innermost
    /// loop that has several values. So only this setting varies within a row.
    std::size_t row = 1;
};

/// Returns all combinations of the settings, in the order of nested loops. From the outermost to the
/// innermost loop, these are impulse response (blur kernel), shutter, focal length, f-number and focus
/// distance. File names always contain f-number and focus distance. They contain the other settings only if
/// these vary.
///
/// Throws Error(wrong_arguments) if there are more than `most_pictures` images, or if a list that needs a
/// value (SweepAxes) is empty. Also throws the errors of reading a lens prescription.
[[nodiscard]] SweepGrid sweep_grid(const SweepAxes& axes);

/// Replaces the one placeholder in a pattern such as "NAME.%04d" by `i`. Returns nothing for any other
/// pattern.
[[nodiscard]] std::optional<std::string> numbered_name(const std::string& pattern, std::size_t i);

}  // namespace postlens
