// The scene that a command works on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Reads a scene; what its reader made up or skipped becomes warnings. Throws Error(wrong_arguments) where
/// the scene refers to a file that is to be `written`, else as `read_scene`.
[[nodiscard]] Scene read_scene_of_command(const std::string& path, double metres_per_unit,
                                          const std::vector<std::filesystem::path>& written,
                                          CommandResult& out);

}  // namespace postlens
