// The files that assimp may read: the scene file, and the files in the same folder to which it refers.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/mesh/obj_text.h"
#include "scene/referred_files.h"
#include "scene/scene_notes.h"

namespace postlens {

/// Provides files to the library assimp, which reads OBJ scenes. The contents are passed from memory. MTL
/// files (materials) are converted to UTF-8 and rewritten. No files are written. `missing` lists files that
/// cannot be read, and `outside` lists files outside the scene's folder, which are not opened.
class MeshFiles : public Assimp::IOSystem {
  public:
    /// `text` is the content of the scene file, an OBJ file as rewritten by `rewritten_obj`.
    MeshFiles(std::filesystem::path scene_path, std::string text, SceneNotes& notes)
        : scene_path_(std::move(scene_path)), text_(std::move(text)), notes_(notes) {}

    [[nodiscard]] bool Exists(const char* file) const override;
    [[nodiscard]] char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char* mode) override;
    void Close(Assimp::IOStream* stream) override;

    [[nodiscard]] const std::vector<ReferredFile>& opened() const { return opened_; }
    /// Returns the texture options in the MTL files (such as -s and -o of map_Kd), by name of the material.
    [[nodiscard]] const std::map<std::string, MaterialPictures>& pictures() const { return pictures_; }
    [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }
    [[nodiscard]] const std::vector<std::string>& outside() const { return outside_; }

  private:
    [[nodiscard]] std::string as_written(const std::string& file) const;

    std::filesystem::path scene_path_;
    std::string text_;
    std::vector<ReferredFile> opened_;
    std::map<std::string, MaterialPictures> pictures_;
    std::vector<std::string> missing_, outside_;
    SceneNotes& notes_;
};

/// Largest file that assimp may read, in bytes. Assimp needs about ten times as much memory.
inline constexpr std::uintmax_t largest_mesh_file_bytes = std::uintmax_t{1} << 30;

/// Converts UTF-16 text with a byte order mark to UTF-8, with '?' in place of surrogates.
/// Removes the byte order mark from UTF-8 text. Returns any other text unchanged.
[[nodiscard]] std::string as_utf8(std::string text);

}  // namespace postlens
