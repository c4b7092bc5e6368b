// Reads a PLY file into arrays of vertices and faces.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene_notes.h"

namespace postlens {

/// The contents of a PLY file. Values may be infinite or NaN.
struct PlyFile {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  ///< per position, or empty
    std::vector<glm::dvec2> uvs;      ///< per position, or empty
    /// one colour per position, or empty; 1 is full intensity, even if the file stores integers
    std::vector<glm::dvec3> colours;
    /// vertex indices of all faces, face by face; they are not checked, so an index may exceed the number of
    /// positions
    std::vector<std::uint32_t> corners;
    std::vector<std::uint32_t> corner_counts;  ///< per face
    std::vector<glm::dvec2> corner_uvs;        ///< one per entry of `corners`, replaces `uvs`; or empty
    std::string texture_file;                  ///< may be empty
};

/// Reads an ASCII or binary PLY file, with elements and properties in any order.
/// Reads faces and triangle strips, and skips other elements with a note.
/// Needs at most a few times the memory of `bytes`. Throws Error(invalid_input) "FILE: ...".
[[nodiscard]] PlyFile read_ply_file(std::string_view bytes, const std::string& file, SceneNotes& notes);

}  // namespace postlens
