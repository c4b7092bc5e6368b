// Materials that assimp read from MTL, and pictures that OBJ and PLY name, as Whitted's model has them.
#pragma once

#include <assimp/material.h>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tracer/referred_files.h"
#include "tracer/scene.h"
#include "tracer/scene_notes.h"

namespace postlens {

/// The ambient light of scenes from OBJ and PLY, with which Ka counts: exporters write Ka 1 for everything.
inline constexpr double mesh_ambient_light = 0.1;

class MeshMaterials {
  public:
    MeshMaterials(std::filesystem::path scene_path, std::vector<ReferredFile>& files, SceneNotes& notes)
        : scene_path_(std::move(scene_path)), files_(files), notes_(notes) {}

    /// Throws Error(invalid_input) where a picture leads out of the scene's folder.
    [[nodiscard]] Material read(const aiMaterial& from);
    /// White and matt.
    [[nodiscard]] static Material plain();
    /// Null, with a note, where it cannot be read. Throws Error(invalid_input) where it leads out of the
    /// scene's folder.
    [[nodiscard]] std::shared_ptr<const Texture> picture(std::string file);

  private:
    std::shared_ptr<const Texture> picture(const aiMaterial& from, aiTextureType type);

    std::filesystem::path scene_path_;
    std::vector<ReferredFile>& files_;
    SceneNotes& notes_;
    std::map<std::string, std::shared_ptr<const Texture>> textures_;
};

}  // namespace postlens
