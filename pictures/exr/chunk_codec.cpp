#include "pictures/exr/chunk_codec.h"

#include <algorithm>
#include <cstring>
#include <libdeflate.h>
#include <new>

namespace postlens {
namespace {

/// Compression level of deflate, the method by which OpenEXR's ZIP compresses. Level 1 is the fastest. Higher
/// levels make slightly smaller files in much more time (bench/sample_file_bench.cpp).
constexpr int deflate_level = 1;

// Run-length encoding of OpenEXR. A run of equal bytes is stored as its length minus 1, and the byte. A
// sequence of differing bytes is stored as its negated length, and the bytes.
constexpr std::size_t shortest_run = 3;
constexpr std::size_t longest_run = 128;
constexpr std::size_t longest_literal = 127;

/// Never shrinks the buffer: growing it again for a larger chunk would fill it with zeros.
void resize_at_least(Bytes& bytes, std::size_t size) {
    if (bytes.size() < size) bytes.resize(size);
}

/// Prepares the bytes of a chunk for compression, as OpenEXR defines it. First moves the bytes at even
/// positions before those at odd positions. Then replaces each byte by its difference from the previous byte,
/// plus 128.
void predict(ByteView raw, Bytes& apart, Bytes& out) {
    resize_at_least(apart, raw.size());
    resize_at_least(out, raw.size());
    const std::size_t pairs = raw.size() / 2;
    const std::size_t even_count = raw.size() - pairs;
    const std::uint8_t* __restrict from = raw.data();
    std::uint8_t* __restrict even = apart.data();
    std::uint8_t* __restrict odd = apart.data() + even_count;
    for (std::size_t i = 0; i < pairs; ++i) {
        even[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
    }
    if (even_count > pairs) even[pairs] = from[2 * pairs];
    const std::uint8_t* __restrict value = apart.data();
    std::uint8_t* __restrict difference = out.data();
    difference[0] = value[0];
    for (std::size_t i = 1; i < raw.size(); ++i) {
        difference[i] = static_cast<std::uint8_t>(value[i] - value[i - 1] + 128);
    }
}

/// Recovers the bytes from their differences: each byte becomes the previous result plus this byte, minus
/// 128. The first byte stays unchanged.
void sum_differences(std::span<std::uint8_t> bytes) {
    std::size_t i = 0;
    std::uint8_t sum = 128;
    // Computes prefix sums of the 8 bytes of a word: adds the word shifted by 1, 2 and 4 bytes, without carry
    // between bytes.
    constexpr std::uint64_t low_bits = 0x7F7F7F7F7F7F7F7FU;
    constexpr std::uint64_t every_byte = 0x0101010101010101U;
    const auto add = [](std::uint64_t a, std::uint64_t b) {
        return ((a & low_bits) + (b & low_bits)) ^ ((a ^ b) & ~low_bits);
    };
    for (; i + 8 <= bytes.size(); i += 8) {
        std::uint64_t v{};
        std::memcpy(&v, bytes.data() + i, 8);
        v ^= 128 * every_byte;  // subtracts 128 from each byte
        v = add(v, v << 8U);
        v = add(v, v << 16U);
        v = add(v, v << 32U);
        v = add(v, sum * every_byte);
        std::memcpy(bytes.data() + i, &v, 8);
        sum = static_cast<std::uint8_t>(v >> 56U);
    }
    for (; i < bytes.size(); ++i) bytes[i] = sum = static_cast<std::uint8_t>(sum + bytes[i] - 128);
}

void unpredict(Bytes& predicted, std::span<std::uint8_t> raw) {
    sum_differences(predicted);
    const std::size_t pairs = raw.size() / 2;
    const std::size_t even_count = raw.size() - pairs;
    const std::uint8_t* __restrict even = predicted.data();
    const std::uint8_t* __restrict odd = predicted.data() + even_count;
    std::uint8_t* __restrict to = raw.data();
    for (std::size_t i = 0; i < pairs; ++i) {
        to[2 * i] = even[i];
        to[2 * i + 1] = odd[i];
    }
    if (even_count > pairs) to[2 * pairs] = even[pairs];
}

/// Returns the length of the encoded data, or 0 if it is not shorter than `in`.
std::size_t run_length_encode(ByteView in, Bytes& out) {
    resize_at_least(out, in.size() + 2);
    const std::size_t limit = in.size();
    std::size_t written = 0;
    std::size_t i = 0;
    const auto run_at = [&](std::size_t k) {
        const std::size_t end = std::min(in.size(), k + longest_run);
        std::size_t e = k + 1;
        while (e < end && in[e] == in[k]) ++e;
        return e - k;
    };
    while (i < in.size()) {
        const std::size_t run = run_at(i);
        if (run >= shortest_run) {
            if (written + 2 >= limit) return 0;
            out[written++] = static_cast<std::uint8_t>(run - 1);
            out[written++] = in[i];
            i += run;
            continue;
        }
        const std::size_t end = std::min(in.size(), i + longest_literal);
        std::size_t e = i + 1;
        while (e < end && !(e + 2 < in.size() && in[e] == in[e + 1] && in[e] == in[e + 2])) ++e;
        const std::size_t literal = e - i;
        if (written + literal + 1 >= limit) return 0;
        out[written++] = static_cast<std::uint8_t>(-static_cast<int>(literal));
        std::memcpy(out.data() + written, in.data() + i, literal);
        written += literal;
        i = e;
    }
    return written;
}

bool run_length_decode(ByteView in, std::span<std::uint8_t> out) {
    std::size_t i = 0;
    std::size_t written = 0;
    while (i < in.size()) {
        const int byte = in[i++];
        const int head = byte < 128 ? byte : byte - 256;
        const std::size_t count =
            head < 0 ? static_cast<std::size_t>(-head) : static_cast<std::size_t>(head) + 1;
        const std::size_t bytes_in = head < 0 ? count : 1;
        if (bytes_in > in.size() - i || count > out.size() - written) return false;
        if (head < 0) {
            std::memcpy(out.data() + written, in.data() + i, count);
        } else {
            std::memset(out.data() + written, in[i], count);
        }
        i += bytes_in;
        written += count;
    }
    return written == out.size();
}

}  // namespace

void ChunkCodec::FreeCompressor::operator()(libdeflate_compressor* c) const {
    libdeflate_free_compressor(c);
}
void ChunkCodec::FreeDecompressor::operator()(libdeflate_decompressor* d) const {
    libdeflate_free_decompressor(d);
}

ChunkCodec::ChunkCodec() = default;
ChunkCodec::~ChunkCodec() = default;

int rows_per_chunk(ChunkCompression compression) {
    return compression == ChunkCompression::zip ? 16 : 1;
}

bool inflate_zlib(ByteView packed, std::span<std::uint8_t> raw) {
    libdeflate_decompressor* d = libdeflate_alloc_decompressor();
    if (d == nullptr) throw std::bad_alloc();
    // With a null pointer for the actual size, libdeflate fails unless it fills the output exactly.
    const auto result =
        libdeflate_zlib_decompress(d, packed.data(), packed.size(), raw.data(), raw.size(), nullptr);
    libdeflate_free_decompressor(d);
    return result == LIBDEFLATE_SUCCESS;
}

ByteView ChunkCodec::compress(ChunkCompression compression, ByteView raw, Bytes& packed) {
    if (compression == ChunkCompression::none || raw.size() < 2) return raw;
    predict(raw, apart_, scratch_);
    const ByteView predicted(scratch_.data(), raw.size());
    std::size_t size = 0;
    if (compression == ChunkCompression::rle) {
        size = run_length_encode(predicted, packed);
    } else {
        if (!compressor_) compressor_.reset(libdeflate_alloc_compressor(deflate_level));
        if (!compressor_) throw std::bad_alloc();
        resize_at_least(packed, raw.size());
        // The limit raw.size() - 1 makes libdeflate fail if the data do not become smaller. The chunk is then
        // stored uncompressed.
        size = libdeflate_zlib_compress(compressor_.get(), predicted.data(), predicted.size(), packed.data(),
                                        raw.size() - 1);
    }
    return size == 0 ? raw : ByteView(packed.data(), size);
}

bool ChunkCodec::decompress(ChunkCompression compression, ByteView packed, std::span<std::uint8_t> raw) {
    if (packed.size() == raw.size()) {
        std::copy(packed.begin(), packed.end(), raw.begin());
        return true;
    }
    if (compression == ChunkCompression::none || packed.size() > raw.size()) return false;
    scratch_.resize(raw.size());
    if (compression == ChunkCompression::rle) {
        if (!run_length_decode(packed, scratch_)) return false;
    } else {
        if (!decompressor_) decompressor_.reset(libdeflate_alloc_decompressor());
        if (!decompressor_) throw std::bad_alloc();
        // With a null pointer for the actual size, libdeflate fails unless it fills the output exactly.
        if (libdeflate_zlib_decompress(decompressor_.get(), packed.data(), packed.size(), scratch_.data(),
                                       scratch_.size(), nullptr) != LIBDEFLATE_SUCCESS) {
            return false;
        }
    }
    unpredict(scratch_, raw);
    return true;
}

}  // namespace postlens
