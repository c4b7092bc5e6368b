#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "scene/gltf/gltf_scene.h"
#include "scene/mesh/mesh_scene.h"
#include "scene/nff/nff_scene.h"
#include "scene/scene.h"
#include "scene/toml/toml_scene.h"

namespace postlens {
namespace {

constexpr std::array<std::string_view, 6> endings{".toml", ".nff", ".gltf", ".glb", ".obj", ".ply"};

std::string ending_of(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

Scene read_by_ending(const std::filesystem::path& path, const SceneReadOptions& options) {
    const std::string ending = ending_of(path);
    if (ending == ".toml") return read_toml_scene(path, options);
    if (ending == ".nff") return read_nff_scene(path, options);
    if (ending == ".gltf" || ending == ".glb") return read_gltf_scene(path, options);
    if (ending == ".obj" || ending == ".ply") return read_mesh_scene(path, options);
    fail(ExitCode::invalid_input, "{}: not a scene by its ending (got '{}'; expected {})", path.string(),
         ending, fmt::join(endings, ", "));
}

}  // namespace

bool is_scene_file(const std::filesystem::path& path) {
    return std::find(endings.begin(), endings.end(), ending_of(path)) != endings.end();
}

Scene read_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    constexpr double least = 1e-9, most = 1e9;
    if (!(options.metres_per_unit >= least && options.metres_per_unit <= most)) {
        fail(ExitCode::wrong_arguments, "--metres-per-unit: out of range (got {}; expected {} to {})",
             options.metres_per_unit, least, most);
    }
    constexpr double least_lumens = 1e-6, most_lumens = 1e6;
    if (!(options.lumens_per_watt >= least_lumens && options.lumens_per_watt <= most_lumens)) {
        fail(ExitCode::wrong_arguments, "--lumens-per-watt: out of range (got {}; expected {} to {})",
             options.lumens_per_watt, least_lumens, most_lumens);
    }
    Scene scene = read_by_ending(path, options);
    scene.metres_per_unit = options.metres_per_unit;
    return scene;
}

}  // namespace postlens
