// The subcommands of `lens`: optics without a scene.
#pragma once

#include <optional>

#include "apps/command.h"

namespace postlens {

struct LensCommandOptions {
    double focal_length_mm = 50, f_number = 8, focus_m = 1;
    std::optional<double> depth_m;
    double coc_limit_mm = 0.03;
    double pixel_pitch_um = 18.75;  ///< 36 mm over 1920 px
};

[[nodiscard]] CommandResult run_lens_coc(const LensCommandOptions& options);
[[nodiscard]] CommandResult run_lens_dof(const LensCommandOptions& options);

}  // namespace postlens
