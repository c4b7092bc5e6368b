// Files that a scene names: found only within the scene's own folder, and counted in its SHA-256.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/scene.h"

namespace postlens {

/// A file that a scene refers to: as the scene writes it, and where it is.
struct ReferredFile {
    std::string as_written;
    std::filesystem::path path;
};

/// The file that a scene names, looked up from the scene file's folder; links are followed before that is
/// judged. Empty where it leads out of the folder. It need not exist.
[[nodiscard]] std::optional<std::filesystem::path> inside_scene_folder(
    const std::filesystem::path& scene_path, const std::string& as_written);

/// Says in the scene what it refers to, and its SHA-256: of its own bytes and then, for each file, of the
/// line "name as written, space, SHA-256 of its bytes". Throws Error(invalid_input) where a file cannot be
/// read.
void name_sources(std::string_view bytes, const std::vector<ReferredFile>& files, Scene& scene);

}  // namespace postlens
