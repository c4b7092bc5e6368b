// Opens OpenEXR files and reads their headers. Every size is checked before memory is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pictures/exr/chunk_codec.h"

namespace postlens {

/// A file opened for reading. Functions that fail throw Error(invalid_input) with the name of the file.
/// Several threads may read at the same time.
class InputFile {
  public:
    explicit InputFile(const std::filesystem::path& path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    InputFile(InputFile&&) = delete;
    InputFile& operator=(InputFile&&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// Reads from byte `offset` of the file until `out` is full. Throws if the file ends before.
    void read_at(std::uint64_t offset, std::span<std::uint8_t> out) const;

  private:
    std::string name_;
    int fd_ = -1;
    std::uint64_t size_ = 0;
};

/// A rectangle of pixels. Its corners are inclusive, as in OpenEXR's box2i.
struct Window {
    std::int32_t x_min = 0, y_min = 0, x_max = -1, y_max = -1;
    friend bool operator==(const Window&, const Window&) = default;
};

/// A matrix for row vectors, as everywhere in OpenEXR: p' = p M. Its elements are m[4 * row + column].
using Matrix44 = std::array<double, 16>;

struct ExrChannel {
    enum class Type : std::int32_t { uint32 = 0, half = 1, float32 = 2 };
    std::string name;
    Type type = Type::float32;
    friend bool operator==(const ExrChannel&, const ExrChannel&) = default;
};

/// The attributes of one part, by name. A getter returns an empty optional if the attribute is absent. It
/// throws Error(invalid_input) if the type is wrong or the value is damaged.
class ExrPart {
  public:
    explicit ExrPart(std::string file_name) : file_(std::move(file_name)) {}
    void add(std::string name, std::string type, ByteView value);

    [[nodiscard]] std::optional<int> get_int(std::string_view name) const;
    [[nodiscard]] std::optional<double> get_double(std::string_view name) const;
    [[nodiscard]] std::optional<std::string> get_string(std::string_view name) const;
    [[nodiscard]] std::optional<Window> get_window(std::string_view name) const;
    [[nodiscard]] std::optional<Matrix44> get_matrix(std::string_view name) const;
    [[nodiscard]] std::optional<ChunkCompression> compression() const;
    /// Returns the channels in the order of the file. Throws if a channel is subsampled.
    [[nodiscard]] std::optional<std::vector<ExrChannel>> channels() const;
    [[nodiscard]] std::optional<ByteView> raw(std::string_view name, std::string_view type) const;

    [[nodiscard]] std::size_t size() const { return attributes_.size(); }

  private:
    struct Attribute {
        std::string type;
        Bytes value;
    };
    std::string file_;
    std::map<std::string, Attribute, std::less<>> attributes_;
};

struct ExrHeaders {
    std::vector<ExrPart> parts;  ///< at least one
    std::uint64_t end = 0;       ///< position at which the chunk offset tables begin
    bool multi_part = false;     ///< the file is a multi-part file, in which each part states its type
    bool tiled = false;          ///< only for a file with a single part: the part is tiled
};

enum class AttributeSizes {
    any,     ///< no check
    filled,  ///< throw if a value does not fill its stated size (fills_its_size)
};

/// Reads the headers of the first parts of an OpenEXR file, at most `most_parts`. If the file has more parts,
/// the position after the headers, ExrHeaders::end, is unknown and therefore not set. Throws
/// Error(invalid_input) if the file is not OpenEXR 2, its headers exceed 64 MB, or a part has more than 1000
/// attributes.
[[nodiscard]] ExrHeaders read_exr_headers(const InputFile& file, std::size_t most_parts,
                                          AttributeSizes sizes = AttributeSizes::any);

}  // namespace postlens
