#include "apps/exposure.h"

#include <algorithm>
#include <cctype>

#include "tracer/exposure.h"

namespace postlens {

std::optional<double> exposure_of_samples(const ExposureOption& asked, const std::filesystem::path& path,
                                          Damage damage) {
    if (!asked.automatic) return asked.stops;
    const SampleFileReader file(path, damage);
    if (file.header().auto_exposure_stops) return file.header().auto_exposure_stops;
    return auto_exposure_of(pinhole_picture(file));
}

double exposure_of_scene(const ExposureOption& asked, const Scene& scene, const std::string& camera_name,
                         const CameraOverrides& camera) {
    return asked.automatic ? auto_exposure_stops(scene, camera_name, camera) : asked.stops.value_or(0);
}

void report_exposure(const std::string& path, const Image& image, const std::optional<Crop>& crop,
                     CommandResult& out) {
    out.json["exposure_stops"] = image.exposure_stops.value_or(0);
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".exr") return;
    if (const auto warning = exposure_warning(image, crop))
        out.warnings.push_back({"exposure", warning->text, warning->share});
}

}  // namespace postlens
