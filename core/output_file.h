// Output that is either whole or absent: written beside its target, renamed when complete.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>

namespace postlens {

/// A file being written. Give `temporary_path()` to whatever writes it, then `commit()`.
/// Without `commit()` (an exception, an interruption) the temporary is removed and an older target stays.
/// A target that is a symbolic link keeps the link; the file it leads to is replaced.
/// Throws Error(cannot_write) where the target is a folder, a device or write-protected, or where its folder
/// is missing or not writable: before any work is spent on the contents.
class OutputFile {
  public:
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    OutputFile(OutputFile&&) = delete;
    OutputFile& operator=(OutputFile&&) = delete;

    /// Same folder and same ending as the target, so that writers that go by the ending work.
    /// The file exists, empty, and belongs to this object alone.
    [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// The whole contents at once, for a file that is made in memory; then `commit()`. Throws
    /// Error(cannot_write), on a full disk too.
    void write(std::string_view bytes);

    /// Flushes to disk and renames onto the target; to be called once.
    /// Throws Error(cannot_write) on failure; the older target is then unchanged.
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path destination_;  ///< the target with links followed
    std::filesystem::path temporary_;
    std::optional<std::size_t> slot_;  ///< where the temporary is listed for remove_all_temporaries()
    bool committed_ = false;
};

/// A file that is made in memory, whole or not at all. Throws as OutputFile does.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// Removes the temporaries of every OutputFile alive, for a process that is about to be ended by a signal.
/// Async-signal-safe. The objects must not be used afterwards.
void remove_all_temporaries() noexcept;

}  // namespace postlens
