// `--exposure`: what it comes to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/command.h"
#include "records/exposure.h"

namespace postlens {

/// The stops by which a sample file is to be read; nothing: its own. `auto` is what the file says or, where
/// it does not, auto_exposure_of its pinhole picture.
[[nodiscard]] std::optional<double> exposure_of_samples(const ExposureOption& asked,
                                                        const std::filesystem::path& path, Damage damage);

/// The stops of a scene: asked for, by its preview, or 0.
[[nodiscard]] double exposure_of_scene(const ExposureOption& asked, const Scene& scene,
                                       const std::string& camera_name, const CameraOverrides& camera);

/// The stops of another program's picture: asked for, of its own colours, or 0.
template <typename Picture>
[[nodiscard]] double exposure_of_picture(const ExposureOption& asked, const Picture& picture) {
    return asked.automatic ? auto_exposure_of(picture()) : asked.stops.value_or(0);
}

}  // namespace postlens
