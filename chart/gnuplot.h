// Runs gnuplot as a separate process.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// Throws Error(invalid_input) if `gnuplot` cannot be run. Called before long measurements.
void check_gnuplot();

/// Draws a plot with gnuplot: runs the plot script, and writes the plot to `base`.svg and `base`.png. Also
/// saves the script as `base`.gp. In the script, @TERMINAL@ and @OUTPUT@ are placeholders for gnuplot's
/// terminal (the file format) and output file.
///
/// Throws Error(cannot_write) with gnuplot's first error message.
void draw_with_gnuplot(const std::string& script, const std::filesystem::path& base, int width_px,
                       int height_px);

}  // namespace postlens
