// Resolves the option `--exposure` to a number of stops.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/exposure.h"

namespace postlens {

/// Exposure, stops, at which to read a sample file; empty: the file's own. `auto` gives the automatic
/// exposure stored in the file, or auto_exposure_of its pinhole image if the file has none.
[[nodiscard]] std::optional<double> exposure_of_samples(const ExposureOption& asked,
                                                        const std::filesystem::path& path, Damage damage);

/// Exposure, stops, of a scene: the option's; for `auto`, auto_exposure_stops of the scene; else 0.
[[nodiscard]] double exposure_of_scene(const ExposureOption& asked, const Scene& scene,
                                       const std::string& camera_name, const CameraOverrides& camera);

/// Exposure, stops, of another program's image: the option's; for `auto`, auto_exposure_of the image;
/// otherwise 0.
template <typename Picture>
[[nodiscard]] double exposure_of_picture(const ExposureOption& asked, const Picture& picture) {
    return asked.automatic ? auto_exposure_of(picture()) : asked.stops.value_or(0);
}

}  // namespace postlens
