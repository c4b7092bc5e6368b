// Files that a scene refers to. They must lie in the scene's folder, and enter its SHA-256.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace postlens {

/// A file that a scene refers to: the name in the scene, and the path of the file.
struct ReferredFile {
    std::string as_written;
    std::filesystem::path path;
};

/// Path of a file that a scene refers to, relative to the scene file's folder. Empty if it leads out of the
/// folder, after symbolic links are followed. The file need not exist.
[[nodiscard]] std::optional<std::filesystem::path> inside_scene_folder(
    const std::filesystem::path& scene_path, const std::string& as_written);

/// Sets `referred` and `sha256` of a scene. The SHA-256 covers the bytes of the scene file, then for each
/// referred file a line of its name as written, a space and the SHA-256 of its bytes. Throws
/// Error(invalid_input) if a file cannot be read.
void name_sources(std::string_view bytes, const std::vector<ReferredFile>& files, Scene& scene);

}  // namespace postlens
