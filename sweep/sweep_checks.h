// Checks the settings of a sweep before the first image is made. If a setting is wrong, the functions in this
// file throw Error(wrong_arguments) with the option's name.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "focus/focus.h"
#include "records/sample_file.h"
#include "sweep/grid.h"
#include "sweep/sweep.h"

namespace postlens {

/// Returns the raster positions, in px, at which the circle of confusion is reported for each image of the
/// sweep. These are the positions in the settings. If the settings contain none, they are a grid of 3 x 3
/// points.
[[nodiscard]] std::vector<glm::dvec2> sweep_points(const SweepSettings& s, const SampleHeader& h);

/// Returns the images' file names, in the order of the grid.
[[nodiscard]] std::vector<std::string> sweep_file_names(const SweepSettings& s, const SweepGrid& grid);

/// Checks the CoC limit and the format of the images.
void check_sweep_limits(const SweepSettings& settings);

/// Checks the lens settings of all images.
void check_sweep_lenses(const SweepSettings& settings, const SweepGrid& grid, const SampleHeader& h,
                        FocusMethod method);

/// Returns the files that a sweep of `frame` reads.
[[nodiscard]] std::vector<std::filesystem::path> sweep_inputs(const std::filesystem::path& frame,
                                                              const SweepSettings& settings);

}  // namespace postlens
