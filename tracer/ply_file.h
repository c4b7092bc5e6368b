// A PLY file as arrays: corners with what they carry, and faces.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tracer/scene_notes.h"

namespace postlens {

/// Values as the file has them, finite or not.
struct PlyFile {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  ///< per position, or empty
    std::vector<glm::dvec2> uvs;      ///< per position, or empty
    std::vector<glm::dvec3> colours;  ///< per position, or empty; whole numbers are divided by their largest
    std::vector<std::uint32_t> corners;  ///< of all faces, one after the other; not checked against positions
    std::vector<std::uint32_t> corner_counts;  ///< per face
    std::vector<glm::dvec2> corner_uvs;        ///< per entry of `corners`, or empty: then `uvs` counts
    std::string texture_file;                  ///< may be empty
};

/// Reads ASCII and binary files: elements and properties in any order, lists with counts of any type, faces
/// and triangle strips. An element that is neither is passed over with a note. Takes no more memory than a
/// few times that of `bytes`. Throws Error(invalid_input) "FILE: ...".
[[nodiscard]] PlyFile read_ply_file(std::string_view bytes, const std::string& file, SceneNotes& notes);

}  // namespace postlens
