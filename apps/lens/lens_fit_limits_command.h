// Variants of `lens fit` that need no lens prescription:
// - --pairs fits a thin lens to measured circles of confusion
// - --sharp finds the lens that keeps a range of depths sharp
// - --picture estimates the lens with which an image was made
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "apps/command.h"

namespace postlens {

struct LensFitLimitsOptions {
    std::optional<std::string> pairs;                ///< a CSV file
    std::optional<std::pair<double, double>> sharp;  ///< nearest and farthest sharp depth, m
    std::optional<double> coc_limit_mm, focal_length_mm, f_number;
    std::optional<std::pair<double, double>> sensor_mm;  ///< width, height
    double wavelength_nm = 550;
    std::optional<std::string> picture, frame;  ///< an image with depth of field, and its sample file
    Impulse impulse;
};

/// Parses a range of depths in metres, such as "1.2:4" or "1.2:inf". Throws Error(wrong_arguments).
[[nodiscard]] std::pair<double, double> parse_depths(const std::string& option, const std::string& text);
/// Parses a sensor size in mm, such as "36x24". Throws Error(wrong_arguments).
[[nodiscard]] std::pair<double, double> parse_sensor(const std::string& option, const std::string& text);

/// Runs `lens fit --picture --frame`, which estimates the lens with which an image was made.
[[nodiscard]] CommandResult run_lens_fit_picture(const LensFitLimitsOptions& options);

/// Runs `lens fit --pairs` or `lens fit --sharp`. The first finds a lens that produces the given blur
/// diameters. The second finds a lens that makes a given range of depths sharp. Exactly one of these two
/// options must be given.
[[nodiscard]] CommandResult run_lens_fit_limits(const LensFitLimitsOptions& options);

}  // namespace postlens
