// The command `lens psf`. It computes the impulse response of a lens, and the f-number above which
// diffraction dominates.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "lens/impulse.h"

namespace postlens {

struct LensPsfOptions {
    std::string output;  ///< may be empty with `crossover`
    std::optional<double> focal_length_mm, f_number, focus_m, depth_m;
    std::optional<double> wavelength_nm;  ///< 550 if absent
    double pixel_pitch_um = 18.75;        ///< film 36 mm wide with 1920 px
    int size_px = 0;                      ///< 0 means as large as the response
    Impulse impulse;
    std::optional<std::string> profile;  ///< a CSV file to write
    bool crossover = false;
};

[[nodiscard]] CommandResult run_lens_psf(const LensPsfOptions& options);

}  // namespace postlens
