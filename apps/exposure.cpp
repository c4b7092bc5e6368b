#include "apps/exposure.h"

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

}  // namespace postlens
