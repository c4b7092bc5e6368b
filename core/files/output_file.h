// Output files that are either complete or absent: each is written under a temporary name and renamed when
// complete.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>

namespace postlens {

/// A file that is being written. Write to `temporary_path()`, then call `commit()`. Without `commit()` (after
/// an exception or an interruption) the temporary file is removed, and an older target stays. If the target
/// is a symbolic link, the file that the link points to is replaced. The constructor throws
/// Error(cannot_write) if the target cannot be written: if it is a folder, a device or write-protected, or if
/// its folder is missing or not writable. So this error appears before any work is spent on the contents.
class OutputFile {
  public:
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    OutputFile(OutputFile&&) = delete;
    OutputFile& operator=(OutputFile&&) = delete;

    /// Path of the temporary file, which exists, is empty and belongs to this object only. It has the folder
    /// and the extension of the target, because image writers choose the format by the extension.
    [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Writes the whole contents of the file. Call `commit()` afterwards. Throws Error(cannot_write), for
    /// example if the disk is full.
    void write(std::string_view bytes);

    /// Flushes the file to disk and renames it to the target. Must be called only once. Throws
    /// Error(cannot_write) on failure; an older target is then unchanged.
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path destination_;  ///< the target with links followed
    std::filesystem::path temporary_;
    std::optional<std::size_t>
        slot_;  ///< index of the temporary's path in the list of remove_all_temporaries()
    bool committed_ = false;
};

/// Writes a file with the given contents, completely or not at all. Throws as OutputFile does.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// Removes the temporary files of all OutputFile objects, before a signal ends the process.
/// Async-signal-safe. The objects must not be used afterwards.
void remove_all_temporaries() noexcept;

}  // namespace postlens
