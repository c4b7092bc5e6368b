/// @file
/// Makes the picture that a lens with an open shutter takes of a frame. Defocus and motion blur are
/// added in one step, not one after the other.
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
    /// Exposure time (`--shutter`). The default is the exposure time in the file, beginning at the frame's
    /// instant.
    std::optional<Shutter> shutter = {};
    /// How much light the shutter transmits while it is open (`--shutter-curve`): "box" (default),
    /// "triangle", or the name of a file.
    std::string shutter_curve = {};
    /// File with the motion of objects (`--paths`, docs/motion_paths.md). It replaces the motion in the
    /// sample file.
    std::filesystem::path paths = {};
    /// "lightfield" (default), "hybrid" or "auto" (`--method`).
    std::string method = {};
    /// Number of views that are averaged (`--views`). A view is the picture from one lens point at one
    /// instant. Default: 128.
    std::optional<int> views = {};
    /// PSNR that the method "auto" tries to reach, in dB, from 10 to 80 (`--target-db`).
    std::optional<double> target_db = {};
    /// The scene from which the frame was traced (`--scene`), as in `FocusSettings`.
    std::filesystem::path scene = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< In stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further options of `postlens shoot`, for example {"--strict"}.
    std::vector<std::string> options = {};
};

/// Makes the picture of a sample file through a lens and an open shutter at once. The picture is the mean of
/// many views, each from its own lens point and at its own instant.
///
/// Throws Error(wrong_arguments) for a wrong setting or a frame without records. Throws Error(invalid_input)
/// if the file is damaged or was not traced from `scene`. Throws Error(out_of_memory) if the memory does not
/// suffice.
/// @param frame The sample file.
/// @param settings Lens, shutter and method.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The picture, the lens that was used, and the error.
[[nodiscard]] FocusResult shoot(const Frame& frame, const ShootSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
