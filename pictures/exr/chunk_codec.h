// Compresses and expands chunks of OpenEXR files by the methods of sample files: none, RLE and deflate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct libdeflate_compressor;
struct libdeflate_decompressor;

namespace postlens {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Values of OpenEXR's `compression` attribute.
enum class ChunkCompression : std::uint8_t { none = 0, rle = 1, zips = 2, zip = 3 };

/// Returns the number of scanlines per chunk: 16 for zip, otherwise 1.
[[nodiscard]] int rows_per_chunk(ChunkCompression compression);

/// Compresses and expands chunks like OpenEXR: first separates bytes at even and odd positions, then takes
/// their differences, then encodes run lengths or a zlib stream. Each thread needs its own object, which has
/// scratch memory.
class ChunkCodec {
  public:
    ChunkCodec();
    ~ChunkCodec();
    ChunkCodec(const ChunkCodec&) = delete;
    ChunkCodec& operator=(const ChunkCodec&) = delete;
    ChunkCodec(ChunkCodec&&) = delete;
    ChunkCodec& operator=(ChunkCodec&&) = delete;

    /// Compresses `raw` into `packed`. Returns `raw` if it does not become smaller: OpenEXR recognises an
    /// uncompressed chunk by its size.
    [[nodiscard]] ByteView compress(ChunkCompression compression, ByteView raw, Bytes& packed);

    /// Decompresses `packed` into `raw`. Returns false if `packed` is damaged or does not fill `raw` exactly.
    [[nodiscard]] bool decompress(ChunkCompression compression, ByteView packed, std::span<std::uint8_t> raw);

  private:
    struct FreeCompressor {
        void operator()(libdeflate_compressor* c) const;
    };
    struct FreeDecompressor {
        void operator()(libdeflate_decompressor* d) const;
    };
    std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor_;
    std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor_;
    Bytes apart_, scratch_;
};

/// Expands a zlib stream into `raw`. Returns false if the stream is damaged or does not fill `raw` exactly.
[[nodiscard]] bool inflate_zlib(ByteView packed, std::span<std::uint8_t> raw);

}  // namespace postlens
