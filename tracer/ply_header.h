// The header of a PLY file: which elements follow it, and how their values are stored.
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
    PlyType type = PlyType::none;        ///< of a value, or of an entry of a list
    PlyType count_type = PlyType::none;  ///< of the number of entries; none: no list
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::string texture_file;  ///< named in a comment, as MeshLab and VCGlib do; may be empty
};

/// Takes the header off the front of `bytes`; the first byte of data remains first, whatever it is. Lines end
/// as the first one does: with CR alone, else with LF, before which a CR is dropped. Throws
/// Error(invalid_input) "FILE: ...".
[[nodiscard]] PlyHeader take_ply_header(std::string_view& bytes, const std::string& file);

}  // namespace postlens
