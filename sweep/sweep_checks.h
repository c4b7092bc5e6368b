// Checks the settings of a sweep before the first image is made, and lists the files that the sweep reads and
// writes. All functions throw Error(wrong_arguments) with the name of the option.
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

/// Returns the raster positions, in px, at which the sweep reports the CoC (circle of confusion). These are
/// the positions in the settings. If there are none, they form a 3 x 3 grid.
[[nodiscard]] std::vector<glm::dvec2> sweep_points(const SweepSettings& s, const SampleHeader& h);

/// Returns the file names of the images, in the order of the grid.
[[nodiscard]] std::vector<std::string> sweep_file_names(const SweepSettings& s, const SweepGrid& grid);

/// Checks the CoC limit and the format of the images.
void check_sweep_limits(const SweepSettings& settings);

/// Checks the lens settings of all images before the first one is made.
void check_sweep_lenses(const SweepSettings& settings, const SweepGrid& grid, const SampleHeader& h,
                        FocusMethod method);

/// Returns the files that a sweep of the sample file `frame` reads.
[[nodiscard]] std::vector<std::filesystem::path> sweep_inputs(const std::filesystem::path& frame,
                                                              const SweepSettings& settings);

}  // namespace postlens
