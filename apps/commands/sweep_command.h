// The command `sweep`, which makes images of one sample file with many lens settings.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "sweep/sweep.h"

namespace postlens {

struct SweepOptions {
    std::string input, output;
    /// Lists of values, as typed by the user. An image is made for each combination of a value from every
    /// list. If the list of f-numbers, focal lengths or focus distances is absent, the value stored in the
    /// sample file is used.
    std::optional<std::string> f_number, focal_length, focus, shutter, impulse;
    Impulse modifiers;          ///< squeeze, cats_eye and spherical of every impulse response
    std::string curve = "box";  ///< box, triangle or a file
    std::optional<std::string> paths;
    RetraceOptions retrace;
    std::optional<std::string> format;
    SweepSettings settings;
    ExposureOption exposure;
    bool strict = false;
};

/// Returns the number of images of a sweep. If an option is wrong, throws the same error as run_sweep.
[[nodiscard]] std::size_t pictures_of(const SweepOptions& options);
[[nodiscard]] CommandResult run_sweep(const SweepOptions& options);

}  // namespace postlens
