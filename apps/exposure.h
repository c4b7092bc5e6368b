// Converts the option `--exposure` to a number of stops.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/exposure.h"

namespace postlens {

/// Returns the exposure, in stops, that the option --exposure (`asked`) states for the sample file `path`. If
/// its value is `auto`, the exposure is computed from the file. If the option is absent, the result is empty,
/// and the exposure stored in the file applies.
[[nodiscard]] std::optional<double> exposure_of_samples(const ExposureOption& asked,
                                                        const std::filesystem::path& path, Damage damage);

/// Returns the exposure, in stops, at which a scene is rendered. `asked` is the option --exposure. If its
/// value is `auto`, the exposure is computed from the scene. If the option is absent, the exposure is 0.
[[nodiscard]] double exposure_of_scene(const ExposureOption& asked, const Scene& scene,
                                       const std::string& camera_name, const CameraOverrides& camera);

/// Returns the exposure, in stops, at which another program's image is read. `asked` is the option
/// --exposure. If its value is `auto`, the exposure is computed from the image, which the function `picture`
/// returns. If the option is absent, the exposure is 0.
template <typename Picture>
[[nodiscard]] double exposure_of_picture(const ExposureOption& asked, const Picture& picture) {
    return asked.automatic ? auto_exposure_of(picture()) : asked.stops.value_or(0);
}

}  // namespace postlens
