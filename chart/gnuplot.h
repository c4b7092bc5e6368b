// Runs gnuplot as a separate process.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// Throws Error(invalid_input) if the program `gnuplot` cannot be run. It is called before a long
/// measurement, so that the error appears early.
void check_gnuplot();

/// Runs a plot script twice to draw `base`.svg and `base`.png, and saves the script as `base`.gp. @TERMINAL@
/// and @OUTPUT@ in the script are replaced by gnuplot's terminal and output file. If a plot fails, incomplete
/// files are removed. Error(cannot_write) is then thrown with the first line of gnuplot's error message.
void draw_with_gnuplot(const std::string& script, const std::filesystem::path& base, int width_px,
                       int height_px);

}  // namespace postlens
