#include "apps/scene_input.h"

#include "apps/share.h"
#include "core/files/file_identity.h"
#include "tracer/exposure.h"

namespace postlens {
namespace {

// Returns a unit of the scene (metres per unit or lumens per watt). It is the user's value `asked`, else the
// value `of_trace` stored in the sample file, else 1. Throws if both are given and differ.
double unit_of(const char* option, const std::optional<double>& asked,
               const std::optional<double>& of_trace) {
    if (asked && of_trace && *asked != *of_trace) {
        fail(ExitCode::wrong_arguments, "{}: other than in the trace (got {}; expected {})", option, *asked,
             *of_trace);
    }
    return asked.value_or(of_trace.value_or(1));
}

}  // namespace

Scene read_scene_of_command(const std::string& path, const SceneReadOptions& units,
                            const std::vector<std::filesystem::path>& written, CommandResult& out) {
    Scene scene = read_scene(path, units);
    remember_digest(path, scene);
    refuse_overwriting(scene.referred, written);
    for (const std::string& note : scene.notes) out.warnings.push_back({"scene", note});
    return scene;
}

Scene read_scene_of_file(const std::string& path, const std::optional<double>& metres_per_unit,
                         const std::optional<double>& lumens_per_watt, const SampleFileReader& file,
                         const std::vector<std::filesystem::path>& written, CommandResult& out) {
    // Reads the scene with the same units as the sample file. Old sample files do not state metres per unit
    // and lumens per watt. They were made with 1 for each of these, so unit_of uses 1.
    const SampleHeader& h = file.header();
    Scene scene = read_scene_of_command(
        path,
        {.metres_per_unit = unit_of("--metres-per-unit", metres_per_unit, h.metres_per_unit),
         .lumens_per_watt = unit_of("--lumens-per-watt", lumens_per_watt, h.lumens_per_watt)},
        written, out);
    expose(scene, file.exposure_stops());
    return scene;
}

}  // namespace postlens
