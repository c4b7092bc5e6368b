/// @file
/// Adds motion blur: makes the picture that a pinhole camera with an open shutter takes of a frame.
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
    /// Exposure time (`--shutter`). The default is the exposure time in the file, beginning at the frame's
    /// instant.
    std::optional<Shutter> shutter = {};
    /// How much light the shutter transmits while it is open (`--shutter-curve`): "box" (default),
    /// "triangle", or the name of a file.
    std::string shutter_curve = {};
    /// File with the motion of objects (`--paths`, docs/motion_paths.md). It replaces the motion in the
    /// sample file.
    std::filesystem::path paths = {};
    /// "convolve", "lightfield" or "auto" (`--method`). Default: "auto".
    std::string method = {};
    /// Number of instants that the method "lightfield" averages (`--views`). The default depends on the
    /// longest motion of an object in the picture: the smallest of 131, 257 and 521 that has at least one
    /// instant for every 2 px of this motion, or 521 if none has.
    std::optional<int> views = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< In stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further options of `postlens motionblur`, for example {"--vectors=u,v"}.
    std::vector<std::string> options = {};
};

/// What `motionblur` has made.
struct MotionBlurResult {
    /// The picture, or the part of it that `crop` selects. It is empty if `options` contain `--output`,
    /// because the picture is then written to that file.
    Picture picture = {};
    std::string method = {};   ///< Method that was used.
    double touched_share = 0;  ///< Fraction of the pixels that the shutter changes, 0 to 1.
    Report report = {};        ///< Report of `postlens motionblur`. Its JSON lists the objects.
};

/// Makes the picture of a frame through a pinhole and an open shutter [Potmesil & Chakravarty 1983]. The
/// frame is a sample file, or a picture of another program with motion vectors.
///
/// Throws Error(wrong_arguments) for a wrong setting, Error(invalid_input) for a damaged file, and
/// Error(out_of_memory) if the memory does not suffice.
/// @param frame The sample file, or the picture of another program.
/// @param settings Shutter and method.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The picture, and the fraction of pixels that the shutter changes.
[[nodiscard]] MotionBlurResult motionblur(const Frame& frame, const MotionBlurSettings& settings = {},
                                          Job* job = nullptr);

}  // namespace postlens::api
