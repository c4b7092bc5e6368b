// The scene that a command works on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Reads a scene; what its reader made up or skipped becomes warnings. Throws Error(wrong_arguments) where
/// the scene refers to a file that is to be `written`, else as `read_scene`.
[[nodiscard]] Scene read_scene_of_command(const std::string& path, const SceneReadOptions& units,
                                          const std::vector<std::filesystem::path>& written,
                                          CommandResult& out);

/// The same for the scene that a sample file was traced from, at the exposure by which the file is read.
/// `lumens_per_watt`: absent: as the file says.
[[nodiscard]] Scene read_scene_of_file(const std::string& path, double metres_per_unit,
                                       const std::optional<double>& lumens_per_watt,
                                       const SampleFileReader& file,
                                       const std::vector<std::filesystem::path>& written, CommandResult& out);

}  // namespace postlens
