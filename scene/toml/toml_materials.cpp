#include "scene/toml/toml_materials.h"

#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "core/files/text_file.h"
#include "core/text.h"
#include "pictures/image.h"
#include "records/motion/scene_limits.h"
#include "records/motion/toml_transform.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;
using Name = std::string_view;

constexpr NumberRange colour_range{.min = 0, .max = largest_colour};
constexpr NumberRange share_range{.min = 0, .max = 1};

Texture read_checker(const TomlTable& t, double unit) {
    static constexpr std::array<Name, 6> known{"name", "kind", "size_m", "offset_m", "even", "odd"};
    t.allow_only({known});
    NumberRange size = extent_range(unit);
    size.may_be_infinite = true;
    Checker checker;
    checker.dimensions = 3;
    checker.size = unit * t.required(t.number_or_vec3("size_m", size), "size_m");
    checker.offset = unit * t.vec3("offset_m", length_range(unit)).value_or(dvec3(0));
    checker.even = t.number_or_vec3("even", colour_range).value_or(checker.even);
    checker.odd = t.number_or_vec3("odd", colour_range).value_or(checker.odd);
    return Texture(checker);
}

Texture read_checker_uv(const TomlTable& t) {
    static constexpr std::array<Name, 6> known{"name", "kind", "size_uv", "offset_uv", "even", "odd"};
    t.allow_only({known});
    const auto size =
        t.required(t.numbers("size_uv", 2, {.min = 1e-9, .max = 1e9, .may_be_infinite = true}), "size_uv");
    const auto offset =
        t.numbers("offset_uv", 2, {.min = -1e9, .max = 1e9}).value_or(std::vector<double>{0, 0});
    Checker checker;
    checker.dimensions = 2;
    checker.size = {size[0], size[1], 1};
    checker.offset = {offset[0], offset[1], 0};
    checker.even = t.number_or_vec3("even", colour_range).value_or(checker.even);
    checker.odd = t.number_or_vec3("odd", colour_range).value_or(checker.odd);
    return Texture(checker);
}

Texture read_image_texture(const TomlTable& t, const std::filesystem::path& scene_path,
                           std::vector<ReferredFile>& files) {
    static constexpr std::array<Name, 5> known{"name", "kind", "file", "repeat", "filter"};
    static constexpr std::array<Name, 2> filters{"bilinear", "nearest"};
    t.allow_only({known});
    const std::string file = t.required(t.text("file"), "file");
    ImageTexture texture;
    const auto repeat = t.numbers("repeat", 2, {.min = 1e-6, .max = 1e6}).value_or(std::vector<double>{1, 1});
    texture.repeat = dvec2(repeat[0], repeat[1]);
    texture.nearest = t.choice("filter", filters).value_or(0) == 1;
    const auto path = inside_scene_folder(scene_path, file);
    if (!path) {
        t.fail_at("file", "'file' leads out of the scene's folder (got {}; expected a path inside it)",
                  excerpt(file));
    }
    try {
        check_regular_file(*path);
        Image image = read_image(*path, PictureValues::stored);
        texture.width = image.width;
        texture.height = image.height;
        texture.rgb = std::move(image.rgb);
    } catch (const Error& error) {
        if (error.code() != ExitCode::invalid_input) throw;
        t.fail_at("file", "{}", error.what());
    }
    for (const float value : texture.rgb) {
        if (!std::isfinite(value)) t.fail_at("file", "{} has pixels that are not finite", excerpt(file));
    }
    files.push_back({file, *path});
    return Texture(std::move(texture));
}

std::shared_ptr<const Texture> find_texture(const TomlTable& t, std::string_view key,
                                            const TexturesByName& textures) {
    const auto name = t.text(key);
    if (!name) return nullptr;
    const auto at = textures.find(*name);
    if (at != textures.end()) return at->second;
    std::vector<std::string_view> known;
    for (const auto& [other, texture] : textures) known.push_back(other);
    t.fail_at(key, "{}", unknown_name("texture", *name, known));
}

Material read_material(const TomlTable& t, const TexturesByName& textures) {
    static constexpr std::array<Name, 16> known{"name",
                                                "colour",
                                                "ambient",
                                                "diffuse",
                                                "diffuse_transmission",
                                                "specular",
                                                "shininess",
                                                "reflection",
                                                "transmission",
                                                "ior",
                                                "fresnel",
                                                "emission",
                                                "colour_texture",
                                                "emission_texture",
                                                "reflection_exponent",
                                                "transmission_exponent"};
    constexpr NumberRange exponent{.min = 0, .max = 1e12, .may_be_infinite = true};
    t.allow_only({known});
    Material m;
    m.name = t.required(t.text("name"), "name");
    // `colour` multiplies only the three diffuse coefficients.
    const dvec3 colour = t.number_or_vec3("colour", colour_range).value_or(dvec3(1));
    m.ambient = colour * t.number_or_vec3("ambient", colour_range).value_or(m.ambient);
    m.diffuse = colour * t.number_or_vec3("diffuse", colour_range).value_or(m.diffuse);
    m.diffuse_transmission =
        colour * t.number_or_vec3("diffuse_transmission", colour_range).value_or(m.diffuse_transmission);
    m.specular = t.number_or_vec3("specular", colour_range).value_or(m.specular);
    m.shininess = t.number("shininess", {.min = 0, .max = 1e9}).value_or(m.shininess);
    m.reflection = t.number_or_vec3("reflection", share_range).value_or(m.reflection);
    m.transmission = t.number_or_vec3("transmission", share_range).value_or(m.transmission);
    m.ior = t.number("ior", {.min = 0.01, .max = 100}).value_or(m.ior);
    m.fresnel = t.flag("fresnel").value_or(m.fresnel);
    // `reflection_grazing` and `specular_grazing` are the colours of the reflection and of the highlight at
    // grazing angles. Both are 1 by default. But if a material has no reflection or no highlight at all, it
    // must have none at grazing angles either. Therefore, that colour is set to 0.
    if (m.reflection == dvec3(0)) m.reflection_grazing = dvec3(0);
    if (m.specular == dvec3(0)) m.specular_grazing = dvec3(0);
    m.reflection_exponent = t.number("reflection_exponent", exponent).value_or(m.reflection_exponent);
    m.transmission_exponent = t.number("transmission_exponent", exponent).value_or(m.transmission_exponent);
    m.emission = t.number_or_vec3("emission", colour_range).value_or(m.emission);
    m.colour_texture = find_texture(t, "colour_texture", textures);
    m.emission_texture = find_texture(t, "emission_texture", textures);
    return m;
}

}  // namespace

std::string unknown_name(std::string_view kind, std::string_view got,
                         const std::vector<std::string_view>& known) {
    if (known.empty())
        return fmt::format("no {} has this name (got {}; the scene has none)", kind, excerpt(got));
    return fmt::format("no {} has this name (got {}; nearest known name: '{}')", kind, excerpt(got),
                       nearest_word(got, known));
}

TexturesByName read_textures(const TomlTable& root, const std::filesystem::path& scene_path,
                             double metres_per_unit, std::vector<ReferredFile>& files) {
    static constexpr std::array<Name, 3> kinds{"checker", "checker_uv", "image"};
    static constexpr std::array<Name, 11> all_keys{"name", "kind",   "size_m",  "offset_m",
                                                   "even", "odd",    "size_uv", "offset_uv",
                                                   "file", "repeat", "filter"};
    TexturesByName textures;
    for (TomlTable& t : root.tables("texture", "texture")) {
        t.allow_only({all_keys});
        const std::string name = t.required(t.text("name"), "name");
        t.rename(fmt::format("texture '{}'", name));
        const std::size_t kind = t.required(t.choice("kind", kinds), "kind");
        Texture texture = kind == 0   ? read_checker(t, metres_per_unit)
                          : kind == 1 ? read_checker_uv(t)
                                      : read_image_texture(t, scene_path, files);
        if (!textures.try_emplace(name, std::make_shared<const Texture>(std::move(texture))).second) {
            t.fail_at("name", "two textures have the name {}", excerpt(name));
        }
    }
    return textures;
}

std::vector<Material> read_materials(const TomlTable& root, const TexturesByName& textures) {
    std::vector<Material> materials;
    std::set<std::string, std::less<>> names;
    for (TomlTable& t : root.tables("material", "material")) {
        if (const auto name = t.text("name")) t.rename(fmt::format("material '{}'", *name));
        materials.push_back(read_material(t, textures));
        if (!names.insert(materials.back().name).second) {
            t.fail_at("name", "two materials have the name {}", excerpt(materials.back().name));
        }
    }
    return materials;
}

}  // namespace postlens
