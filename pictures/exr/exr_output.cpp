#include "pictures/exr/exr_output.h"

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <numeric>
#include <type_traits>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "pictures/exr/exr_attributes.h"

namespace postlens {
namespace {

constexpr std::size_t buffer_bytes = 1U << 18U;
/// Version field of an OpenEXR file: version 2. A file with several parts has the flags 0x1000 (multi-part)
/// and 0x800 (deep data).
constexpr std::uint32_t one_part_version = 2U, parts_version = 2U | 0x800U | 0x1000U;

template <typename... T>
auto little_endian(T... values) {
    static_assert((std::is_integral_v<T> && ...));
    std::array<std::uint8_t, (sizeof(T) + ...)> bytes{};
    std::size_t at = 0;
    ((std::memcpy(bytes.data() + at, &values, sizeof(T)), at += sizeof(T)), ...);
    return bytes;
}

/// Output stream that lets the OpenEXR library write a header into memory.
class MemoryStream : public Imf::OStream {
  public:
    MemoryStream() : Imf::OStream("header") {}
    void write(const char c[], int n) override {
        const auto count = static_cast<std::size_t>(n);
        if (bytes.size() < position_ + count) bytes.resize(position_ + count);
        std::memcpy(bytes.data() + position_, c, count);
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    Bytes bytes;

  private:
    std::uint64_t position_ = 0;
};

}  // namespace

ExrOutput::ExrOutput(const std::filesystem::path& path, std::string shown_name,
                     const std::vector<Imf::Header>& headers, std::vector<std::size_t> chunks,
                     std::optional<std::size_t> chunk_bytes)
    : name_(std::move(shown_name)), offsets_(headers.size()), chunks_(std::move(chunks)) {
    MemoryStream stream;
    for (const Imf::Header& header : headers) header.writeTo(stream);
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd_ < 0) fail_with_errno();
    try {
        if (chunk_bytes && is_one_part()) checksum_.emplace();
        append(little_endian(exr_magic, is_one_part() ? one_part_version : parts_version));
        append(stream.bytes);
        if (!is_one_part()) append(little_endian(std::uint8_t{0}));  // an empty header ends the list
        table_position_ = position_;
        const std::size_t entries = std::accumulate(chunks_.begin(), chunks_.end(), std::size_t{0});
        if (checksum_) {
            constexpr std::size_t before_data = 8;  // row number and size
            const std::uint64_t first = position_ + entries * 8;
            for (std::size_t i = 0; i < entries; ++i)
                append(little_endian(std::uint64_t{first + i * (before_data + *chunk_bytes)}));
        } else {
            append(Bytes(entries * 8));
        }
    } catch (...) {  // the destructor does not run if the constructor throws
        ::close(fd_);
        throw;
    }
}

std::optional<std::uint64_t> ExrOutput::checksum() const {
    if (!checksum_) return std::nullopt;
    return checksum_->value();
}

ExrOutput::~ExrOutput() {
    if (fd_ >= 0) ::close(fd_);
}

void ExrOutput::fail_with_errno() const {
    fail(ExitCode::cannot_write, "{}: cannot write ({})", name_, std::strerror(errno));
}

void ExrOutput::append(ByteView bytes) {
    position_ += bytes.size();
    if (bytes.size() < buffer_bytes / 4) {
        buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
        if (buffer_.size() >= buffer_bytes) flush();
    } else {
        flush();
        put(bytes);
    }
}

void ExrOutput::flush() {
    put(buffer_);
    buffer_.clear();
}

void ExrOutput::put(ByteView bytes) {
    if (checksum_) checksum_->add(bytes.data(), bytes.size());
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_with_errno();
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void ExrOutput::begin_chunk(int part) {
    auto& offsets = offsets_[static_cast<std::size_t>(part)];
    assert(offsets.size() < chunks_[static_cast<std::size_t>(part)]);
    offsets.push_back(position_);
}

void ExrOutput::write_flat_chunk(int part, int y, ByteView data) {
    begin_chunk(part);
    if (!is_one_part()) append(little_endian(part));
    append(little_endian(y, static_cast<std::int32_t>(data.size())));
    append(data);
}

void ExrOutput::write_deep_chunk(int part, int y, ByteView counts, ByteView data,
                                 std::uint64_t unpacked_data_bytes) {
    begin_chunk(part);
    append(little_endian(part, y, static_cast<std::uint64_t>(counts.size()),
                         static_cast<std::uint64_t>(data.size()), unpacked_data_bytes));
    append(counts);
    append(data);
}

std::uint64_t ExrOutput::finish() {
    flush();
    for (std::size_t part = 0; part < chunks_.size(); ++part) assert(offsets_[part].size() == chunks_[part]);
    if (!checksum_) write_table();
    // Some file systems report a full disk only when the file is closed.
    if (::close(std::exchange(fd_, -1)) != 0) fail_with_errno();
    return position_;
}

void ExrOutput::write_table() {
    Bytes table;
    for (std::size_t part = 0; part < chunks_.size(); ++part) {
        for (const std::uint64_t offset : offsets_[part]) {
            const auto bytes = little_endian(offset);
            table.insert(table.end(), bytes.begin(), bytes.end());
        }
    }
    if (::lseek(fd_, static_cast<off_t>(table_position_), SEEK_SET) < 0) fail_with_errno();
    put(table);
}

}  // namespace postlens
