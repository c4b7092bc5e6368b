// Reads a PLY file into arrays of vertices and faces.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene_notes.h"

namespace postlens {

/// The content of a PLY file. Values may be infinite or NaN.
struct PlyFile {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;     ///< per position, or empty
    std::vector<glm::dvec2> uvs;         ///< per position, or empty
    std::vector<glm::dvec3> colours;     ///< per position, or empty; integers are scaled so that 1 is full
    std::vector<std::uint32_t> corners;  ///< of all faces, face by face; may exceed the number of positions
    std::vector<std::uint32_t> corner_counts;  ///< per face
    std::vector<glm::dvec2> corner_uvs;        ///< per entry of `corners`, instead of `uvs`; or empty
    std::string texture_file;                  ///< may be empty
};

/// Reads ASCII and binary files with elements and properties in any order, list counts of any type, faces and
/// triangle strips. Other elements are skipped with a note. Needs at most a few times the memory of `bytes`.
/// Throws Error(invalid_input) "FILE: ...".
[[nodiscard]] PlyFile read_ply_file(std::string_view bytes, const std::string& file, SceneNotes& notes);

}  // namespace postlens
