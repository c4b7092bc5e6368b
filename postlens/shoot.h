/// @file
/// Makes the picture of a frame through a lens and an open shutter at once.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/focus.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `shoot`.
struct ShootSettings {
    LensSettings lens = {};  ///< Default: the lens of the file.
    /// Exposure time (`--shutter`). Default: the exposure in the file, which begins at the instant of the
    /// frame.
    std::optional<Shutter> shutter = {};
    /// Transmission while the shutter is open (`--shutter-curve`): "box" (default), "triangle" or a file.
    std::string shutter_curve = {};
    /// File with the motion of objects, which replaces that of the sample file (`--paths`,
    /// docs/motion_paths.md).
    std::filesystem::path paths = {};
    /// "lightfield" (default), "hybrid" or "auto" (`--method`).
    std::string method = {};
    /// Number of lens points, each at its own instant (`--views`). Default: 128.
    std::optional<int> views = {};
    /// Target PSNR of "auto", dB, 10 to 80 (`--target-db`).
    std::optional<double> target_db = {};
    /// The scene from which the frame was traced (`--scene`), as in `FocusSettings`.
    std::filesystem::path scene = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< Stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further options of `postlens shoot`, for example {"--strict"}.
    std::vector<std::string> options = {};
};

/// Makes the picture of a sample file through a lens and an open shutter at once. The picture is the mean of
/// many views, each with its own lens point and its own instant.
///
/// Throws Error(wrong_arguments) for a wrong setting or a frame without records, Error(invalid_input) for a
/// damaged file or another scene, and Error(out_of_memory).
/// @param frame The sample file.
/// @param settings Lens, shutter and method.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return Picture and figures.
[[nodiscard]] FocusResult shoot(const Frame& frame, const ShootSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
