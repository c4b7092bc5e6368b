#include "pictures/exr/exr_input.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/text.h"
#include "pictures/exr/exr_attributes.h"

namespace postlens {
namespace {

constexpr std::uint64_t largest_header_bytes = 64U << 20U;
constexpr std::size_t most_attributes = 1000;
constexpr std::size_t longest_name = 255;

constexpr std::uint32_t tiled_flag = 0x200;
constexpr std::uint32_t multi_part_flag = 0x1000;

template <typename T>
T load(const std::uint8_t* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

/// Reads the bytes of a header in order. Loads more of the file when needed.
class HeaderReader {
  public:
    explicit HeaderReader(const InputFile& file) : file_(file) {}

    std::uint64_t position() const { return position_; }

    ByteView take(std::uint64_t count) {
        if (count > file_.size() - position_) {
            fail(ExitCode::invalid_input, "{}: header is cut off or damaged (ends in byte {})", file_.name(),
                 file_.size());
        }
        const std::uint64_t end = position_ + count;
        if (end > largest_header_bytes) {
            fail(ExitCode::invalid_input, "{}: header is too large (expected at most {} MB)", file_.name(),
                 largest_header_bytes >> 20U);
        }
        if (end > bytes_.size()) {
            const std::uint64_t loaded = bytes_.size();
            bytes_.resize(std::min(file_.size(), std::max<std::uint64_t>({end, 2 * loaded, 65536})));
            file_.read_at(loaded, std::span(bytes_).subspan(loaded));
        }
        const ByteView view(bytes_.data() + position_, count);
        position_ = end;
        return view;
    }

    template <typename T>
    T take_number() {
        return load<T>(take(sizeof(T)).data());
    }

    /// Reads a name that ends with a zero byte.
    std::string take_name() {
        std::string name;
        for (;;) {
            const char c = static_cast<char>(take(1)[0]);
            if (c == '\0') return name;
            name += c;
            if (name.size() > longest_name) {
                fail(ExitCode::invalid_input, "{}: header is damaged (a name longer than {} bytes)",
                     file_.name(), longest_name);
            }
        }
    }

  private:
    const InputFile& file_;
    Bytes bytes_;
    std::uint64_t position_ = 0;
};

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
    size_ = check_regular_file(path);
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) fail(ExitCode::invalid_input, "{}: cannot read ({})", name_, std::strerror(errno));
}

InputFile::~InputFile() {
    ::close(fd_);
}

void InputFile::read_at(std::uint64_t offset, std::span<std::uint8_t> out) const {
    if (offset > size_ || out.size() > size_ - offset) {
        fail(ExitCode::invalid_input, "{}: file is cut off or damaged (got {} bytes; expected {} more at {})",
             name_, size_, out.size(), offset);
    }
    while (!out.empty()) {
        const ssize_t got = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) {
            fail(ExitCode::invalid_input, "{}: cannot read ({})", name_,
                 got < 0 ? std::strerror(errno) : "file became shorter");
        }
        out = out.subspan(static_cast<std::size_t>(got));
        offset += static_cast<std::uint64_t>(got);
    }
}

void ExrPart::add(std::string name, std::string type, ByteView value) {
    attributes_[std::move(name)] = Attribute{std::move(type), Bytes(value.begin(), value.end())};
}

std::optional<ByteView> ExrPart::raw(std::string_view name, std::string_view type) const {
    const auto it = attributes_.find(name);
    if (it == attributes_.end()) return std::nullopt;
    if (it->second.type != type) {
        fail(ExitCode::invalid_input, "{}: attribute {} has a wrong type (expected {})", file_, name, type);
    }
    return ByteView(it->second.value);
}

namespace {

/// Reads the bytes as `count` numbers of type T.
template <typename T, std::size_t count>
std::optional<std::array<T, count>> numbers(std::optional<ByteView> bytes, const std::string& file,
                                            std::string_view name) {
    if (!bytes) return std::nullopt;
    if (bytes->size() != count * sizeof(T)) {
        fail(ExitCode::invalid_input, "{}: attribute {} is damaged (got {} bytes; expected {})", file, name,
             bytes->size(), count * sizeof(T));
    }
    std::array<T, count> values{};
    std::memcpy(values.data(), bytes->data(), bytes->size());
    return values;
}

}  // namespace

std::optional<int> ExrPart::get_int(std::string_view name) const {
    const auto n = numbers<std::int32_t, 1>(raw(name, "int"), file_, name);
    return n ? std::optional<int>((*n)[0]) : std::nullopt;
}

std::optional<double> ExrPart::get_double(std::string_view name) const {
    const auto n = numbers<double, 1>(raw(name, "double"), file_, name);
    return n ? std::optional<double>((*n)[0]) : std::nullopt;
}

std::optional<std::string> ExrPart::get_string(std::string_view name) const {
    const auto bytes = raw(name, "string");
    return bytes ? std::optional<std::string>(std::string(bytes->begin(), bytes->end())) : std::nullopt;
}

std::optional<Window> ExrPart::get_window(std::string_view name) const {
    const auto n = numbers<std::int32_t, 4>(raw(name, "box2i"), file_, name);
    return n ? std::optional<Window>(Window{(*n)[0], (*n)[1], (*n)[2], (*n)[3]}) : std::nullopt;
}

std::optional<Matrix44> ExrPart::get_matrix(std::string_view name) const {
    return numbers<double, 16>(raw(name, "m44d"), file_, name);
}

std::optional<ChunkCompression> ExrPart::compression() const {
    const auto n = numbers<std::uint8_t, 1>(raw("compression", "compression"), file_, "compression");
    if (!n) return std::nullopt;
    if ((*n)[0] > static_cast<std::uint8_t>(ChunkCompression::zip)) {
        fail(ExitCode::invalid_input, "{}: unexpected compression (got {}; expected 0 to 3)", file_, (*n)[0]);
    }
    return static_cast<ChunkCompression>((*n)[0]);
}

std::optional<std::vector<ExrChannel>> ExrPart::channels() const {
    const auto bytes = raw("channels", "chlist");
    if (!bytes) return std::nullopt;
    // A channel is stored as name, zero byte, int32 type, uint8 linear flag, 3 unused bytes, int32 x sampling
    // and int32 y sampling. A zero byte ends the list.
    constexpr std::size_t tail = 16;
    std::vector<ExrChannel> channels;
    ByteView rest = *bytes;
    for (;;) {
        const auto zero = std::find(rest.begin(), rest.end(), std::uint8_t{0});
        const auto length = static_cast<std::size_t>(zero - rest.begin());
        if (zero != rest.end() && length == 0 && rest.size() == 1) return channels;
        if (zero == rest.end() || length == 0 || rest.size() - length - 1 < tail) {
            fail(ExitCode::invalid_input, "{}: list of channels is damaged", file_);
        }
        const std::uint8_t* fields = rest.data() + length + 1;
        const auto type = load<std::int32_t>(fields);
        if (type < 0 || type > 2 || load<std::int32_t>(fields + 8) != 1 ||
            load<std::int32_t>(fields + 12) != 1) {
            fail(ExitCode::invalid_input, "{}: list of channels is damaged", file_);
        }
        channels.push_back({std::string(rest.begin(), zero), static_cast<ExrChannel::Type>(type)});
        rest = rest.subspan(length + 1 + tail);
    }
}

ExrHeaders read_exr_headers(const InputFile& file, std::size_t most_parts, AttributeSizes sizes) {
    HeaderReader reader(file);
    if (file.size() < 8 || reader.take_number<std::uint32_t>() != exr_magic) {
        fail(ExitCode::invalid_input, "{}: not a postlens sample file (not an OpenEXR file)", file.name());
    }
    const auto version = reader.take_number<std::uint32_t>();
    if ((version & 0xFFU) != 2) {
        fail(ExitCode::invalid_input, "{}: not a postlens sample file (got OpenEXR version {}; expected 2)",
             file.name(), version & 0xFFU);
    }
    ExrHeaders headers;
    headers.multi_part = (version & multi_part_flag) != 0;
    headers.tiled = (version & tiled_flag) != 0;
    for (;;) {
        std::string name = reader.take_name();
        if (name.empty()) {  // an empty header ends the list
            if (headers.parts.empty())
                fail(ExitCode::invalid_input, "{}: header is damaged (no part)", file.name());
            headers.end = reader.position();
            return headers;
        }
        if (headers.parts.size() == most_parts) return headers;
        ExrPart& part = headers.parts.emplace_back(file.name());
        for (std::size_t count = 0; !name.empty(); ++count) {
            if (count == most_attributes) {
                fail(ExitCode::invalid_input, "{}: header is damaged (more than {} attributes)", file.name(),
                     most_attributes);
            }
            std::string type = reader.take_name();
            const auto bytes = reader.take_number<std::int32_t>();
            if (bytes < 0) {
                fail(ExitCode::invalid_input, "{}: header is damaged (an attribute of {} bytes)", file.name(),
                     bytes);
            }
            const ByteView value = reader.take(static_cast<std::uint64_t>(bytes));
            if (sizes == AttributeSizes::filled && !fills_its_size(type, value)) {
                fail(ExitCode::invalid_input,
                     "{}: header is damaged (got an attribute of type {} in {} bytes)", file.name(),
                     excerpt(type), bytes);
            }
            const bool manifest = type == "idmanifest";
            part.add(std::move(name), std::move(type), value);
            name = reader.take_name();
            // The OpenEXR library 3.1 has an error in reading the attribute idmanifest. It loses the
            // attribute after idmanifest if the name of this attribute has at most four characters. So that
            // nothing is lost silently, a file with such an attribute is rejected.
            constexpr std::size_t read_over = 4;
            if (manifest && sizes == AttributeSizes::filled && name.size() <= read_over) {
                fail(ExitCode::invalid_input,
                     "{}: cannot read (got an attribute {} behind idManifest; expected a name of {} or more "
                     "letters)",
                     file.name(), excerpt(name), read_over + 1);
            }
        }
        if (!headers.multi_part) {
            headers.end = reader.position();
            return headers;
        }
    }
}

}  // namespace postlens
