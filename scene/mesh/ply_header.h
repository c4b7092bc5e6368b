// Reads the header of a PLY file: its elements, and how their values are stored.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace postlens {

enum class PlyType { none, int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyFormat { ascii, little_endian, big_endian };

[[nodiscard]] std::size_t bytes_of(PlyType type);

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::none;  ///< type of a value, or of each entry of a list
    /// type of the number that precedes a list and counts its entries; `none` if the property is not a list
    PlyType count_type = PlyType::none;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::string texture_file;  ///< from a "TextureFile" comment, which MeshLab and VCGlib write; or empty
};

/// Reads the header of a PLY file and removes it from the front of `bytes`. All lines of the header must end
/// like the first one: either with CR alone, or with LF. A CR before LF is ignored. Throws
/// Error(invalid_input) with a message that begins with "FILE: ", where FILE is `file`.
[[nodiscard]] PlyHeader take_ply_header(std::string_view& bytes, const std::string& file);

}  // namespace postlens
