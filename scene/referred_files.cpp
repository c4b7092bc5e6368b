#include "scene/referred_files.h"

#include "scene/file_digest.h"

namespace postlens {

namespace fs = std::filesystem;

std::optional<fs::path> inside_scene_folder(const fs::path& scene_path, const std::string& as_written) {
    // Rejects names that contain a NUL, because the operating system would read only the part before it.
    if (as_written.empty() || as_written.find('\0') != std::string::npos) return std::nullopt;
    if (fs::path(as_written).is_absolute()) return std::nullopt;
    std::error_code error;
    const fs::path folder = fs::canonical(scene_path, error).parent_path();
    if (error) return std::nullopt;
    fs::path path = fs::weakly_canonical(folder / as_written, error);
    const fs::path inside = path.lexically_relative(folder);
    if (error || inside.empty() || *inside.begin() == "..") return std::nullopt;
    return path;
}

void name_sources(std::string_view bytes, const std::vector<ReferredFile>& files, Scene& scene) {
    Sha256 digest;
    digest.add(bytes);
    for (const ReferredFile& file : files) {
        digest.add(file.as_written);
        digest.add(" ");
        digest.add(sha256_of_file(file.path));
        digest.add("\n");
        scene.referred.push_back(file.path);
    }
    scene.sha256 = digest.hex();
}

}  // namespace postlens
