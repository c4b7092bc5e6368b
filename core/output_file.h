// Output that is either whole or absent: written beside its target, renamed when complete.
#pragma once

#include <filesystem>
#include <string>

namespace postlens {

/// A file being written. Give `temporary_path()` to whatever writes it, then `commit()`.
/// Without `commit()` (an exception, an interruption) the temporary is removed and an older target stays.
/// Throws Error(cannot_write) where the target is a folder, its folder is missing or not writable.
class OutputFile {
  public:
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    OutputFile(OutputFile&&) = delete;
    OutputFile& operator=(OutputFile&&) = delete;

    /// Same folder and same ending as the target, so that writers that go by the ending work.
    [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Flushes to disk and renames onto the target. Throws Error(cannot_write) on failure.
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    bool committed_ = false;
};

}  // namespace postlens
