#include "apps/scene_input.h"

#include "apps/share.h"
#include "core/files/file_identity.h"
#include "tracer/exposure.h"

namespace postlens {

Scene read_scene_of_command(const std::string& path, const SceneReadOptions& units,
                            const std::vector<std::filesystem::path>& written, CommandResult& out) {
    Scene scene = read_scene(path, units);
    remember_digest(path, scene);
    refuse_overwriting(scene.referred, written);
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    return scene;
}

Scene read_scene_of_file(const std::string& path, double metres_per_unit,
                         const std::optional<double>& lumens_per_watt, const SampleFileReader& file,
                         const std::vector<std::filesystem::path>& written, CommandResult& out) {
    // A sample file without this value was written by an old version, which did not convert the intensities
    // of light sources. That corresponds to 1 lm/W.
    const double lumens = lumens_per_watt.value_or(file.header().lumens_per_watt.value_or(1));
    Scene scene = read_scene_of_command(path, {.metres_per_unit = metres_per_unit, .lumens_per_watt = lumens},
                                        written, out);
    expose(scene, file.exposure_stops());
    return scene;
}

}  // namespace postlens
