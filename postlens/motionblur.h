/// @file
/// Makes the picture of a frame through a pinhole and an open shutter.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/frame.h>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `motionblur`.
struct MotionBlurSettings {
    /// Exposure time (`--shutter`). Default: the exposure in the file, which begins at the instant of the
    /// frame.
    std::optional<Shutter> shutter = {};
    /// Transmission while the shutter is open (`--shutter-curve`): "box" (default), "triangle" or a file.
    std::string shutter_curve = {};
    /// File with the motion of objects, which replaces that of the sample file (`--paths`,
    /// docs/motion_paths.md).
    std::filesystem::path paths = {};
    /// "convolve", "lightfield" or "auto" (`--method`). Default: "auto".
    std::string method = {};
    /// Number of instants that the method "lightfield" averages (`--views`). Default: one per two pixels of
    /// the longest motion, 128 to 512.
    std::optional<int> views = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< Stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further options of `postlens motionblur`, for example {"--vectors=u,v"}.
    std::vector<std::string> options = {};
};

/// What `motionblur` has made.
struct MotionBlurResult {
    /// The picture, cut to the crop. Empty if `options` contain `--output`: the picture is then written to
    /// that file.
    Picture picture = {};
    std::string method = {};   ///< Method that was used.
    double touched_share = 0;  ///< Fraction of the pixels that the shutter changes, 0 to 1.
    Report report = {};        ///< Of `postlens motionblur`; its JSON lists the objects.
};

/// Makes the picture of a frame through a pinhole and an open shutter [Potmesil & Chakravarty 1983]. The
/// frame is a sample file, or a picture of another program with motion vectors.
///
/// Throws Error(wrong_arguments) for a wrong setting, Error(invalid_input) for a damaged file, and
/// Error(out_of_memory).
/// @param frame The sample file, or the picture of another program.
/// @param settings Shutter and method.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return Picture and figures.
[[nodiscard]] MotionBlurResult motionblur(const Frame& frame, const MotionBlurSettings& settings = {},
                                          Job* job = nullptr);

}  // namespace postlens::api
