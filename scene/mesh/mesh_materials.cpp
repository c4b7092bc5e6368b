#include "scene/mesh/mesh_materials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/text.h"
#include "pictures/image.h"
#include "records/motion/scene_limits.h"
#include "scene/metallic_roughness.h"

namespace postlens {
namespace {

using glm::dvec3;

// Clamps a value to [0, most]. A value that is not finite becomes 0.
double sane(double value, double most) {
    return std::isfinite(value) ? std::clamp(value, 0.0, most) : 0.0;
}

dvec3 colour(const aiMaterial& from, const char* key, unsigned type, unsigned index, const dvec3& otherwise,
             double most) {
    aiColor3D c;
    if (from.Get(key, type, index, c) != aiReturn_SUCCESS) return otherwise;
    return {sane(static_cast<double>(c.r), most), sane(static_cast<double>(c.g), most),
            sane(static_cast<double>(c.b), most)};
}

std::optional<double> number(const aiMaterial& from, const char* key, unsigned type, unsigned index) {
    ai_real value = 0;
    if (from.Get(key, type, index, value) != aiReturn_SUCCESS || !std::isfinite(value)) return std::nullopt;
    return static_cast<double>(value);
}

}  // namespace

Material MeshMaterials::plain() {
    Material m;
    m.name = "default";
    m.ambient = m.diffuse;
    return m;
}

Material MeshMaterials::read(const aiMaterial& from, const MaterialPictures& pictures) {
    Material m;
    m.name = printable_name(from.GetName().C_Str(), "material");
    const dvec3 kd = colour(from, AI_MATKEY_COLOR_DIFFUSE, dvec3(0.8), largest_colour);
    const double d = std::clamp(number(from, AI_MATKEY_OPACITY).value_or(1), 0.0, 1.0);
    const double ni = std::clamp(number(from, AI_MATKEY_REFRACTI).value_or(1), 0.0, 100.0);
    const dvec3 ke = colour(from, AI_MATKEY_COLOR_EMISSIVE, dvec3(0), largest_colour);
    const auto roughness = number(from, AI_MATKEY_ROUGHNESS_FACTOR),
               metallic = number(from, AI_MATKEY_METALLIC_FACTOR);
    int illum = 2;
    // assimp has no named constant for the key under which its MTL reader stores `illum`.
    (void)from.Get("$mat.illum", 0, 0, illum);

    if (roughness || metallic) {
        const MetallicRoughness s{.base = glm::min(kd, dvec3(1)),
                                  .alpha = d,
                                  .metallic = std::clamp(metallic.value_or(0), 0.0, 1.0),
                                  .roughness = std::clamp(roughness.value_or(1), 0.0, 1.0),
                                  .ior = ni > 1 ? ni : 1.5,
                                  .emission = ke};
        std::string name = std::move(m.name);
        m = whitted_material(s);
        m.name = std::move(name);
        m.ambient = m.diffuse;
    } else {
        m.ambient = colour(from, AI_MATKEY_COLOR_AMBIENT, dvec3(0), largest_colour);
        m.diffuse = d * kd;
        m.specular = colour(from, AI_MATKEY_COLOR_SPECULAR, dvec3(0), largest_colour);
        m.shininess = std::clamp(number(from, AI_MATKEY_SHININESS).value_or(32), 0.0, 1e9);
        m.emission = ke;
        if (illum >= 3) m.reflection = glm::min(m.specular, dvec3(1));
        m.transmission = (1 - d) * colour(from, AI_MATKEY_COLOR_TRANSPARENT, dvec3(1), 1);
        const bool refracts = illum == 6 || illum == 7;
        m.ior = refracts && d < 1 && ni >= 0.01 ? ni : 1;
    }
    m.colour_texture = picture(from, aiTextureType_DIFFUSE, pictures.colour.clamp);
    m.emission_texture = picture(from, aiTextureType_EMISSIVE, pictures.emission.clamp);
    if (m.colour_texture && m.emission_texture && !pictures.emission.lies_like(pictures.colour)) {
        notes_.add("the picture of Ke lies on the surface as that of Kd does, whatever its own -s and -o");
    }
    for (const aiTextureType type : {aiTextureType_AMBIENT, aiTextureType_SPECULAR, aiTextureType_OPACITY,
                                     aiTextureType_SHININESS, aiTextureType_HEIGHT, aiTextureType_NORMALS,
                                     aiTextureType_DISPLACEMENT, aiTextureType_REFLECTION}) {
        // A texture of the ambient colour Ka is ignored without a note to the user, because many exporters
        // repeat the texture of the diffuse colour Kd there.
        if (from.GetTextureCount(type) > 0 && type != aiTextureType_AMBIENT) {
            notes_.add("pictures for anything but Kd and Ke are left out");
        }
    }
    return m;
}

std::shared_ptr<const Texture> MeshMaterials::picture(const aiMaterial& from, aiTextureType type,
                                                      bool clamp) {
    aiString name;
    if (from.GetTextureCount(type) == 0 || from.GetTexture(type, 0, &name) != aiReturn_SUCCESS)
        return nullptr;
    return picture(std::string(name.C_Str()), clamp);
}

std::shared_ptr<const Texture> MeshMaterials::picture(std::string file, bool clamp) {
    std::replace(file.begin(), file.end(), '\\', '/');
    const auto [at, is_new] = textures_.try_emplace({file, clamp});
    if (!is_new) return at->second;
    const auto path = inside_scene_folder(scene_path_, file);
    if (!path) {
        fail(ExitCode::invalid_input,
             "{}: a picture leads out of the scene's folder (got {}; expected a path inside it)",
             scene_path_.string(), excerpt(file));
    }
    try {
        check_regular_file(*path);
        Image image = read_image(*path, PictureValues::stored);
        if (std::any_of(image.rgb.begin(), image.rgb.end(), [](float v) { return !std::isfinite(v); })) {
            fail(ExitCode::invalid_input, "it has pixels that are not finite");
        }
        ImageTexture texture;
        texture.width = image.width;
        texture.height = image.height;
        texture.rgb = std::move(image.rgb);
        texture.clamp_u = clamp;
        texture.wrap_v = !clamp;
        at->second = std::make_shared<const Texture>(std::move(texture));
        files_.push_back({file, *path});
    } catch (const Error& error) {
        if (error.code() != ExitCode::invalid_input) throw;
        notes_.add(fmt::format("the picture {} cannot be read and is left out", excerpt(file)));
    }
    return at->second;
}

}  // namespace postlens
