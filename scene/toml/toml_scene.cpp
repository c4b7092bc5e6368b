#include "scene/toml/toml_scene.h"

#include <array>

#include "core/files/text_file.h"
#include "core/toml_reader.h"
#include "records/motion/scene_limits.h"
#include "records/motion/toml_transform.h"
#include "scene/referred_files.h"
#include "scene/scene_defaults.h"
#include "scene/toml/toml_materials.h"
#include "scene/toml/toml_objects.h"
#include "scene/toml/toml_views.h"

namespace postlens {
namespace {

using Name = std::string_view;

void read_settings(const TomlTable& root, Scene& scene) {
    const auto found = root.table("scene");
    if (!found) return;
    TomlTable t = *found;
    t.rename("[scene]");
    static constexpr std::array<Name, 4> known{"name", "background", "ambient_light", "time_s"};
    t.allow_only({known});
    constexpr NumberRange colour{.min = 0, .max = largest_colour};
    scene.name = t.text("name").value_or(scene.name);
    scene.background = t.number_or_vec3("background", colour).value_or(scene.background);
    scene.ambient_light = t.number_or_vec3("ambient_light", colour).value_or(scene.ambient_light);
    scene.time_s = t.number("time_s", {.min = -1e9, .max = 1e9}).value_or(scene.time_s);
}

}  // namespace

Scene read_toml_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    const std::string file = path.string();
    const std::string text = read_text_file(path, largest_toml_bytes);
    const toml::table document = parse_toml(text, file);
    const TomlTable root(file, document, "scene file");
    static constexpr std::array<Name, 6> known{"scene", "camera", "light", "material", "texture", "object"};
    root.allow_only({known});

    Scene scene;
    scene.name = path.stem().string();
    read_settings(root, scene);
    std::vector<ReferredFile> files;
    const TexturesByName textures = read_textures(root, path, options.metres_per_unit, files);
    scene.materials = read_materials(root, textures);
    read_objects(root, options.metres_per_unit, scene);
    scene.cameras = read_cameras(root, options.metres_per_unit);
    scene.lights = read_lights(root, options.metres_per_unit);
    name_sources(text, files, scene);
    // `light = []` means that the scene is dark on purpose.
    complete_scene(scene, path, answers_to_lights(scene) && !root.has("light"), 1);
    return scene;
}

}  // namespace postlens
