// The files that assimp may read: the scene file and files in its folder that it refers to.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/referred_files.h"

namespace postlens {

/// Gives assimp whole files from memory, as UTF-8. UTF-16 is recognised by its byte order mark. Nothing
/// outside of the scene's folder is opened, and nothing is written. The names of requested files that are
/// missing, or that lead out of the folder, are listed.
class MeshFiles : public Assimp::IOSystem {
  public:
    /// `text`: content of the scene file.
    MeshFiles(std::filesystem::path scene_path, std::string text)
        : scene_path_(std::move(scene_path)), text_(std::move(text)) {}

    [[nodiscard]] bool Exists(const char* file) const override;
    [[nodiscard]] char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char* mode) override;
    void Close(Assimp::IOStream* stream) override;

    [[nodiscard]] const std::vector<ReferredFile>& opened() const { return opened_; }
    [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }
    [[nodiscard]] const std::vector<std::string>& outside() const { return outside_; }

  private:
    [[nodiscard]] std::string as_written(const std::string& file) const;

    std::filesystem::path scene_path_;
    std::string text_;
    std::vector<ReferredFile> opened_;
    std::vector<std::string> missing_, outside_;
};

/// Largest file that assimp may read, bytes. Assimp needs about ten times as much memory.
inline constexpr std::uintmax_t largest_mesh_file_bytes = std::uintmax_t{1} << 30;

/// Converts UTF-16 text with a byte order mark to UTF-8, with '?' for surrogates. Removes the byte order mark
/// of UTF-8 text; returns other text unchanged.
[[nodiscard]] std::string as_utf8(std::string text);

}  // namespace postlens
