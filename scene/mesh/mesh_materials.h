// Converts materials of MTL files (read by assimp) to Whitted's model, and reads textures of OBJ and PLY
// files.
#pragma once

#include <assimp/material.h>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scene/mesh/obj_text.h"
#include "scene/referred_files.h"
#include "scene/scene.h"
#include "scene/scene_notes.h"

namespace postlens {

/// Intensity of the ambient light in scenes from OBJ and PLY files. It is multiplied by Ka, the material's
/// ambient coefficient. Exporters write Ka = 1 into most materials, which would make them too bright.
/// Therefore, the intensity is low.
inline constexpr double mesh_ambient_light = 0.1;

class MeshMaterials {
  public:
    MeshMaterials(std::filesystem::path scene_path, std::vector<ReferredFile>& files, SceneNotes& notes)
        : scene_path_(std::move(scene_path)), files_(files), notes_(notes) {}

    /// Converts a material that the library assimp has read. `pictures` contains the options of the
    /// material's texture images, such as their scale and offset. Throws Error(invalid_input) if the path of
    /// a texture leads out of the scene's folder.
    [[nodiscard]] Material read(const aiMaterial& from, const MaterialPictures& pictures);
    /// Returns the default material, which is white and diffuse.
    [[nodiscard]] static Material plain();
    /// Reads a texture image. With `clamp`, the image does not repeat: its border colours continue outside.
    /// Adds a note for the user and returns null if the file cannot be read.
    /// Throws Error(invalid_input) if the path leads out of the scene's folder.
    [[nodiscard]] std::shared_ptr<const Texture> picture(std::string file, bool clamp = false);

  private:
    std::shared_ptr<const Texture> picture(const aiMaterial& from, aiTextureType type, bool clamp);

    std::filesystem::path scene_path_;
    std::vector<ReferredFile>& files_;
    SceneNotes& notes_;
    std::map<std::pair<std::string, bool>, std::shared_ptr<const Texture>> textures_;
};

}  // namespace postlens
