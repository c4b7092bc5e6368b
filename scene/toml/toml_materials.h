// Reads the [[texture]] and [[material]] tables of a .toml scene.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/toml_reader.h"
#include "scene/referred_files.h"
#include "scene/scene.h"

namespace postlens {

using TexturesByName = std::map<std::string, std::shared_ptr<const Texture>, std::less<>>;

/// Reads the textures of a scene, by name. Adds their image files to `files`.
/// These must be in the scene's folder or below.
[[nodiscard]] TexturesByName read_textures(const TomlTable& root, const std::filesystem::path& scene_path,
                                           double metres_per_unit, std::vector<ReferredFile>& files);

[[nodiscard]] std::vector<Material> read_materials(const TomlTable& root, const TexturesByName& textures);

/// Returns an error message for the unknown name `got`, with the nearest of the `known` names.
/// `kind` states what is named, such as "material".
[[nodiscard]] std::string unknown_name(std::string_view kind, std::string_view got,
                                       const std::vector<std::string_view>& known);

}  // namespace postlens
