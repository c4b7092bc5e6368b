// The text of OBJ and MTL files, rewritten so that assimp reads all of it.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <string_view>

#include "scene/scene_notes.h"

namespace postlens {

/// How a texture image of an MTL file is mapped to a surface: at scale * (u, v) + offset.
struct PictureOptions {
    glm::dvec2 scale{1}, offset{0};  ///< values of -s and -o
    bool clamp = false;              ///< of -clamp: outside the unit square, the border colours continue
    [[nodiscard]] bool lies_like(const PictureOptions& other) const {
        return scale == other.scale && offset == other.offset;
    }
};

/// The options of a material's texture images.
struct MaterialPictures {
    PictureOptions colour, emission;  ///< options of map_Kd and map_Ke
};

/// Returns the text of an OBJ file with the same contents, in a form of which assimp 5.2 neither loses nor
/// rejects a line: without blanks around lines, without comments behind numbers, with a digit before every
/// decimal point, and with one `mtllib` line per file name.
[[nodiscard]] std::string rewritten_obj(std::string_view text);

/// Returns the text of an MTL file without comments behind numbers and without `-halo`. The options of map_Kd
/// and map_Ke are removed from the text and stored in `pictures`, by the name of the material. Options that
/// are not read cause notes.
[[nodiscard]] std::string rewritten_mtl(std::string_view text,
                                        std::map<std::string, MaterialPictures>& pictures, SceneNotes& notes);

}  // namespace postlens
