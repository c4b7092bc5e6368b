// Converts the option `--exposure` to a number of stops.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/exposure.h"

namespace postlens {

/// Returns the exposure, in stops, at which to read a sample file. For `auto`, it is the automatic exposure
/// of the file. Without the option, the result is empty, and the exposure that the file states applies.
[[nodiscard]] std::optional<double> exposure_of_samples(const ExposureOption& asked,
                                                        const std::filesystem::path& path, Damage damage);

/// Returns the exposure, in stops, at which to render a scene. For `auto`, it is the automatic exposure of
/// the scene. Without the option, it is 0.
[[nodiscard]] double exposure_of_scene(const ExposureOption& asked, const Scene& scene,
                                       const std::string& camera_name, const CameraOverrides& camera);

/// Returns the exposure, in stops, at which to read another program's image. For `auto`, it is computed from
/// the image that the function `picture` returns. Without the option --exposure, it is 0.
template <typename Picture>
[[nodiscard]] double exposure_of_picture(const ExposureOption& asked, const Picture& picture) {
    return asked.automatic ? auto_exposure_of(picture()) : asked.stops.value_or(0);
}

}  // namespace postlens
