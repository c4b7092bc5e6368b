// `lens fit --pairs` and `lens fit --sharp`: a thin lens from measurements, and from what is to be sharp.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "apps/command.h"

namespace postlens {

struct LensFitLimitsOptions {
    std::optional<std::string> pairs;                ///< a CSV file
    std::optional<std::pair<double, double>> sharp;  ///< near, far; m
    std::optional<double> coc_limit_mm, focal_length_mm, f_number;
    std::optional<std::pair<double, double>> sensor_mm;  ///< width, height
    double wavelength_nm = 550;
    std::optional<std::string> picture, frame;  ///< a picture with depth of field, and its sample file
    Impulse impulse;
};

/// "1.2:4" or "1.2:inf". Throws Error(wrong_arguments).
[[nodiscard]] std::pair<double, double> parse_depths(const std::string& option, const std::string& text);
/// "36x24". Throws Error(wrong_arguments).
[[nodiscard]] std::pair<double, double> parse_sensor(const std::string& option, const std::string& text);

/// `lens fit --picture --frame`: which lens took it.
[[nodiscard]] CommandResult run_lens_fit_picture(const LensFitLimitsOptions& options);

/// Exactly one of `pairs` and `sharp` is to be given.
[[nodiscard]] CommandResult run_lens_fit_limits(const LensFitLimitsOptions& options);

}  // namespace postlens
