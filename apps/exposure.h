// Converts the option `--exposure` to a number of stops.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/exposure.h"

namespace postlens {

/// Returns the exposure, in stops, at which to read a sample file. For `auto`, this is the automatic exposure
/// that the file stores. If the file stores none, auto_exposure_of computes it from the pinhole image.
/// Returns an empty value if the option is not given, so that the file is read at its own exposure.
[[nodiscard]] std::optional<double> exposure_of_samples(const ExposureOption& asked,
                                                        const std::filesystem::path& path, Damage damage);

/// Returns the exposure of a scene in stops. It is the number in the option, or auto_exposure_stops of the
/// scene for `auto`. Without the option, it is 0.
[[nodiscard]] double exposure_of_scene(const ExposureOption& asked, const Scene& scene,
                                       const std::string& camera_name, const CameraOverrides& camera);

/// Returns the exposure, in stops, of an image of another program. It is the number in the option, or
/// auto_exposure_of the image for `auto`. Without the option, it is 0.
template <typename Picture>
[[nodiscard]] double exposure_of_picture(const ExposureOption& asked, const Picture& picture) {
    return asked.automatic ? auto_exposure_of(picture()) : asked.stops.value_or(0);
}

}  // namespace postlens
