// The files to which a scene refers. They must lie in the scene's folder, and are part of its SHA-256.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace postlens {

/// A file to which a scene refers: its name in the scene, and its path.
struct ReferredFile {
    std::string as_written;
    std::filesystem::path path;
};

/// Returns the path of a file to which a scene refers, relative to the folder of the scene file. Empty if the
/// path leads out of this folder after symbolic links are followed. The file need not exist.
[[nodiscard]] std::optional<std::filesystem::path> inside_scene_folder(
    const std::filesystem::path& scene_path, const std::string& as_written);

/// Sets `referred` and `sha256` of a scene. The SHA-256 covers the bytes of the scene file, and one line for
/// each referred file: its name as written, a space, and the SHA-256 of its bytes. Throws
/// Error(invalid_input) if a file cannot be read.
void name_sources(std::string_view bytes, const std::vector<ReferredFile>& files, Scene& scene);

}  // namespace postlens
