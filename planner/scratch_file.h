// A sample file that is needed for a moment.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// A name in a folder of its own among the system's temporary files; the folder goes with its contents.
class ScratchFile {
  public:
    /// Throws Error(cannot_write).
    explicit ScratchFile(const std::string& name);
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
