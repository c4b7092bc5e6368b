// Reads the scene of a command.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Reads a scene. Adds a warning to `out` for everything that the reader assumes or leaves out. Throws the
/// errors of read_scene. `written` lists the files that the command will write. Throws Error(wrong_arguments)
/// if the scene refers to one of them.
[[nodiscard]] Scene read_scene_of_command(const std::string& path, const SceneReadOptions& units,
                                          const std::vector<std::filesystem::path>& written,
                                          CommandResult& out);

/// Reads the scene from which the sample file `file` was traced, and scales its light to the exposure at
/// which this file is read. Throws Error(wrong_arguments) if `metres_per_unit` or `lumens_per_watt` is given
/// and differs from the value in the file. Also throws the errors of read_scene_of_command.
[[nodiscard]] Scene read_scene_of_file(const std::string& path, const std::optional<double>& metres_per_unit,
                                       const std::optional<double>& lumens_per_watt,
                                       const SampleFileReader& file,
                                       const std::vector<std::filesystem::path>& written, CommandResult& out);

}  // namespace postlens
