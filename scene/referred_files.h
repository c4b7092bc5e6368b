// The files to which a scene refers, such as textures. They must be in the scene's folder or below.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace postlens {

/// A file to which a scene refers, with its name in the scene and its path.
struct ReferredFile {
    std::string as_written;
    std::filesystem::path path;
};

/// Returns the path of a file that a scene names relative to its folder. It need not exist.
/// Empty if the path leads out of this folder, also by symbolic links.
[[nodiscard]] std::optional<std::filesystem::path> inside_scene_folder(
    const std::filesystem::path& scene_path, const std::string& as_written);

/// Sets `referred` and `sha256` of a scene. The SHA-256 covers the bytes of the scene file,
/// and a line for each referred file: its name as written, a space and its SHA-256.
/// Throws Error(invalid_input) if a file cannot be read.
void name_sources(std::string_view bytes, const std::vector<ReferredFile>& files, Scene& scene);

}  // namespace postlens
