// A temporary file.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// A path in a new temporary folder. The destructor removes the folder with everything in it.
class ScratchFile {
  public:
    /// Throws Error(cannot_write).
    explicit ScratchFile(std::string name);
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    ScratchFile(ScratchFile&&) = delete;
    ScratchFile& operator=(ScratchFile&&) = delete;

    [[nodiscard]] std::filesystem::path path() const { return folder_ / name_; }

  private:
    std::filesystem::path folder_;
    std::string name_;
};

}  // namespace postlens
