// Output files that are either complete or absent. Each is written under a temporary name, and renamed when
// it is complete.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>

namespace postlens {

/// A file that is written completely or not at all. First, write to `temporary_path()`. Then call `commit()`,
/// which replaces the target by this temporary file. Without this call, the temporary file is removed, and an
/// older target stays. If the target is a symbolic link, the file to which it leads is replaced.
///
/// The constructor throws Error(cannot_write) if the target cannot be written, before the contents are
/// computed.
class OutputFile {
  public:
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    OutputFile(OutputFile&&) = delete;
    OutputFile& operator=(OutputFile&&) = delete;

    /// Path of the temporary file. It exists, is empty at first, and has the extension of the target, by
    /// which image writers choose the format.
    [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }

    /// Writes the whole contents of the file. Call `commit()` afterwards. Throws Error(cannot_write).
    void write(std::string_view bytes);

    /// Flushes the temporary file to disk and renames it to the target. Call it only once. On failure, throws
    /// Error(cannot_write) and keeps an older target.
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path destination_;  ///< the target with links followed
    std::filesystem::path temporary_;
    std::optional<std::size_t>
        slot_;  ///< index of the temporary file in the list that remove_all_temporaries() uses
    bool committed_ = false;
};

/// Writes a file with the given contents, completely or not at all. Throws the same errors as OutputFile.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// Removes the temporary files of all OutputFile objects, which must not be used afterwards. Signal handlers
/// may call it, because it is async-signal-safe.
void remove_all_temporaries() noexcept;

}  // namespace postlens
