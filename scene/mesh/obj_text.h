// Rewrites OBJ and MTL files so that assimp reads every line of them correctly.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <string_view>

#include "scene/scene_notes.h"

namespace postlens {

/// How a texture image of an MTL file is mapped to a surface: it is read at scale * (u, v) + offset.
struct PictureOptions {
    glm::dvec2 scale{1}, offset{0};  ///< values of -s and -o
    bool clamp = false;              ///< option -clamp: the border colours continue outside the unit square
    [[nodiscard]] bool lies_like(const PictureOptions& other) const {
        return scale == other.scale && offset == other.offset;
    }
};

/// The options of a material's texture images.
struct MaterialPictures {
    PictureOptions colour, emission;  ///< options of map_Kd and map_Ke
};

/// Returns the text of an OBJ file in a form in which assimp 5.2 reads every line:
/// - no blanks around lines, and no comments after numbers
/// - a digit before every decimal point
/// - one `mtllib` line per file name
[[nodiscard]] std::string rewritten_obj(std::string_view text);

/// Returns the text of an MTL file in a form that assimp reads correctly, without comments after numbers and
/// without the option `-halo`. The options of the textures map_Kd and map_Ke are moved to `pictures`, under
/// the name of their material. Adds a note for options that are ignored.
[[nodiscard]] std::string rewritten_mtl(std::string_view text,
                                        std::map<std::string, MaterialPictures>& pictures, SceneNotes& notes);

}  // namespace postlens
