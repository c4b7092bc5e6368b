// Runs gnuplot as a separate process.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// Throws Error(invalid_input) if `gnuplot` cannot be run. Called before long measurements.
void check_gnuplot();

/// Draws `base`.svg and `base`.png from a plot script, and saves it as `base`.gp. @TERMINAL@ and @OUTPUT@
/// stand for gnuplot's terminal and output file.
///
/// Throws Error(cannot_write) with gnuplot's first error message.
void draw_with_gnuplot(const std::string& script, const std::filesystem::path& base, int width_px,
                       int height_px);

}  // namespace postlens
