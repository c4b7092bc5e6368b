// The files that assimp may see: the scene's own and, beside it, what it names.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "tracer/referred_files.h"

namespace postlens {

/// Hands out whole files from memory, as UTF-8: of UTF-16 and UTF-8 a byte order mark says what they are.
/// Nothing outside of the scene's folder is opened, and nothing is written. What was asked for and is not
/// there, or leads out, is kept.
class MeshFiles : public Assimp::IOSystem {
  public:
    /// `text`: of the scene file itself.
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

/// Largest file that is given to assimp, bytes: it takes about ten times as much memory.
inline constexpr std::uintmax_t largest_mesh_file_bytes = std::uintmax_t{1} << 30;

/// UTF-16 text with a byte order mark as UTF-8; other text as it is, without its mark. What is no character
/// becomes '?'.
[[nodiscard]] std::string as_utf8(std::string text);

}  // namespace postlens
