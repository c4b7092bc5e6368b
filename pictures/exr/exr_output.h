// Writes an OpenEXR file chunk by chunk. The OpenEXR library writes only the headers, because it writes
// pixels more slowly.
#pragma once

#include <OpenEXR/ImfForward.h>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/checksum.h"
#include "pictures/exr/chunk_codec.h"

namespace postlens {

class ExrOutput {
  public:
    /// Creates the file `path`, or overwrites it, and writes the headers. All functions of this class throw
    /// Error(cannot_write).
    /// - `shown_name`: file name in error messages
    /// - `headers`: one per part; a single part must be a flat scanline image
    /// - `chunks`: number of chunks (blocks of compressed pixels) of each part
    /// - `chunk_bytes`: size of every chunk in bytes, if all have the same size; the file is then written
    ///   from front to back
    ExrOutput(const std::filesystem::path& path, std::string shown_name,
              const std::vector<Imf::Header>& headers, std::vector<std::size_t> chunks,
              std::optional<std::size_t> chunk_bytes = std::nullopt);
    ~ExrOutput();
    ExrOutput(const ExrOutput&) = delete;
    ExrOutput& operator=(const ExrOutput&) = delete;
    ExrOutput(ExrOutput&&) = delete;
    ExrOutput& operator=(ExrOutput&&) = delete;

    /// Writes the next chunk of a part with flat pixels. `y` is the chunk's first scanline.
    void write_flat_chunk(int part, int y, ByteView data);
    /// Writes the next chunk of a part with deep pixels. `y` is the chunk's first scanline.
    void write_deep_chunk(int part, int y, ByteView counts, ByteView data, std::uint64_t unpacked_data_bytes);
    /// Writes the table of chunk positions into the space that was reserved for it behind the headers. Closes
    /// the file and returns its size in bytes.
    std::uint64_t finish();
    /// Returns the XXH3 hash of the finished file, or empty if it was not written from front to back.
    [[nodiscard]] std::optional<std::uint64_t> checksum() const;

  private:
    [[nodiscard]] bool is_one_part() const { return offsets_.size() == 1; }
    void append(ByteView bytes);
    void flush();
    void put(ByteView bytes);
    void begin_chunk(int part);
    void write_table();
    [[noreturn]] void fail_with_errno() const;

    std::string name_;
    int fd_ = -1;
    std::uint64_t position_ = 0;  ///< size of the file so far, including the bytes in `buffer_`
    Bytes buffer_;
    std::uint64_t table_position_ = 0;
    std::vector<std::vector<std::uint64_t>> offsets_;  ///< per part, positions of the chunks written so far
    std::vector<std::size_t> chunks_;
    std::optional<Checksum> checksum_;  ///< of the bytes written; empty unless written from front to back
};

}  // namespace postlens
