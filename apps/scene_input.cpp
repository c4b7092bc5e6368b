#include "apps/scene_input.h"

#include "core/file_identity.h"

namespace postlens {

Scene read_scene_of_command(const std::string& path, double metres_per_unit,
                            const std::vector<std::filesystem::path>& written, CommandResult& out) {
    Scene scene = read_scene(path, {.metres_per_unit = metres_per_unit});
    refuse_overwriting(scene.referred, written);
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    return scene;
}

}  // namespace postlens
