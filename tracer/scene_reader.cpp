#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/error.h"
#include "tracer/nff_scene.h"
#include "tracer/scene.h"
#include "tracer/toml_scene.h"

namespace postlens {

Scene read_scene(const std::filesystem::path& path, const SceneReadOptions& options) {
    constexpr double least = 1e-9, most = 1e9;
    if (!(options.metres_per_unit >= least && options.metres_per_unit <= most)) {
        fail(ExitCode::wrong_arguments, "--metres-per-unit: out of range (got {}; expected {} to {})",
             options.metres_per_unit, least, most);
    }
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".toml") return read_toml_scene(path, options);
    if (ending == ".nff") return read_nff_scene(path, options);
    fail(ExitCode::invalid_input, "{}: not a scene by its ending (got '{}'; expected .toml or .nff)",
         path.string(), ending);
}

}  // namespace postlens
