// gnuplot, as a program of its own.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// Throws Error(invalid_input) where there is no program `gnuplot` to be run; before hours of measuring.
void check_gnuplot();

/// Runs a script that draws, with @TERMINAL@ and @OUTPUT@ in it filled in, once for SVG and once for PNG:
/// `base`.svg and `base`.png, each whole or not there. The script stays beside them as `base`.gp. Throws
/// Error(cannot_write) with gnuplot's own first line of complaint.
void draw_with_gnuplot(const std::string& script, const std::filesystem::path& base, int width_px,
                       int height_px);

}  // namespace postlens
