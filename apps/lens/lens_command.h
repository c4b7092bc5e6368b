// The subcommands of `lens`, which need no scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

struct LensCommandOptions {
    double focal_length_mm = 50, f_number = 8, focus_m = 1;
    std::optional<double> depth_m;
    double coc_limit_mm = 0.03;
    double pixel_pitch_um = 18.75;  ///< film 36 mm wide with 1920 px
};

[[nodiscard]] CommandResult run_lens_coc(const LensCommandOptions& options);
[[nodiscard]] CommandResult run_lens_dof(const LensCommandOptions& options);

/// A lens prescription and its settings, for `lens show`, `lens trace` and `lens fit`.
struct PrescriptionOptions {
    std::string input;
    std::optional<double> f_number, focus_m, wavelength_nm;
    FocusCriterion criterion = FocusCriterion::paraxial;
    FocusMove move = FocusMove::film;
};

struct LensShowOptions {
    PrescriptionOptions lens;
    std::optional<double> film_width_mm;
    std::optional<std::string> output;  ///< file for the drawing
};

struct LensTraceOptions {
    PrescriptionOptions lens;
    std::optional<double> depth_m;  ///< if absent, the focus distance
    std::vector<double> fields_deg;
    double film_width_mm = 36;
    int rays = 65;
    double pixel_pitch_um = 5;
    std::optional<std::string> output, curves, impulse;
};

struct LensFitOptions {
    PrescriptionOptions lens;
    std::pair<double, double> depths_m{1, 100};
    double field_mm = 0;
    double tolerance_px = 0.5;
    double pixel_pitch_um = 18.75;
    int samples = 7;
};

[[nodiscard]] CommandResult run_lens_show(const LensShowOptions& options);
[[nodiscard]] CommandResult run_lens_trace(const LensTraceOptions& options);
[[nodiscard]] CommandResult run_lens_fit(const LensFitOptions& options);

/// Throws Error(wrong_arguments) if the scene depth `depth_m` lies within the lens. Depths are measured from
/// the pinhole, the centre of the lens's entrance pupil. `option` is the name of the option that states the
/// depth.
void check_depth(std::string_view option, double depth_m, const TracedLens& lens);

/// Returns the settings of a lens through which rays are traced. Without `focus_m`, the focus is that of the
/// prescription, or else infinity.
[[nodiscard]] TracedLensSettings traced_lens_settings(const PrescriptionOptions& options,
                                                      double film_radius_mm);

}  // namespace postlens
