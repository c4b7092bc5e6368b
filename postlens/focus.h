/// @file
/// Makes the picture of a frame through a lens.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/frame.h>
#include <postlens/lens.h>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `focus`.
struct FocusSettings {
    LensSettings lens = {};  ///< Default: the lens of the file.
    /// The method: "scatter", "layers", "lightfield", "hybrid", "auto" or "pinhole" (`--method`). The default
    /// is "auto". If `scene` or `target_db` is given, "auto" averages views, i.e. pictures as seen from
    /// single points of the lens, and with `scene`, it replaces some of their colours by traced rays. It
    /// draws as many views as the target PSNR needs. If neither is given, "auto" selects "layers" or
    /// "scatter", depending on the contents of the frame's file.
    std::string method = {};
    /// The methods "lightfield" and "hybrid" average views: pictures as seen from this many points of the
    /// lens (`--views`). Default: 64.
    std::optional<int> views = {};
    /// Number of depths for which the methods "scatter" and "layers" compute an impulse response, from 2 to
    /// 4096 (`--depths`). The default makes circles of confusion accurate to half a pixel.
    std::optional<int> depths = {};
    /// PSNR that the method "auto" tries to reach, in dB, from 10 to 80 (`--target-db`).
    std::optional<double> target_db = {};
    /// The scene from which the frame was traced (`--scene`), for the methods "hybrid" and "auto". Rays are
    /// traced in this scene, because some colours, for example at edges, are not contained in the frame's
    /// samples. The rays also measure the error of the picture.
    std::filesystem::path scene = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< In stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Additional channels (`--passes`), only for a picture of another program: "coc" (diameter of the circle
    /// of confusion), "sides" (fractions of the pixel in front of, in and behind the plane in focus),
    /// "cryptomatte" (masks of objects), "error" (standard error of the mean over the views, only for
    /// the method "lightfield").
    std::vector<std::string> passes = {};
    /// Further options of `postlens focus`, such as {"--depth-model=path", "--exposure=auto"}.
    std::vector<std::string> options = {};
};

/// What `focus` and `shoot` have made.
struct FocusResult {
    /// The picture that was made. If `crop` in the settings is set, it is only this part. If `options` in the
    /// settings contains `--output`, the picture is written to that file instead, and this field is empty.
    Picture picture = {};
    std::string method = {};      ///< Method that was used.
    double focal_length_mm = 0;   ///< Focal length that was used, mm.
    double f_number = 0;          ///< F-number that was used; infinite for a pinhole.
    double focus_distance_m = 0;  ///< Focus distance that was used, m. It may be infinite.
    /// Diameter of the widest circle of confusion (blur disc of the lens), in px. It may be infinite. Empty
    /// in the result of `shoot`, which traces and focuses in one step and does not compute it.
    std::optional<double> largest_coc_px = {};
    /// PSNR of the picture, in dB. It is measured by comparing the picture with rays that are traced at
    /// random places in the scene. It is empty if the settings contain no `scene`, and infinite if the rays
    /// found no difference.
    std::optional<double> stated_db = {};
    std::optional<double> stated_low_db = {};   ///< Lower end of the 95 % interval of `stated_db`, dB.
    std::optional<double> stated_high_db = {};  ///< Upper end of the 95 % interval of `stated_db`, dB.
    Report report = {};                         ///< Report of `postlens focus` or `postlens shoot`.
};

/// Makes the picture of a frame through a lens. The result is bit-identical to that of `postlens focus`. For
/// an infinite f-number, it is the pinhole picture. docs/focus.md describes formulas, methods and limits
/// [Potmesil & Chakravarty 1981].
///
/// Throws Error(wrong_arguments) for a wrong setting, or if neither the settings nor the file define the
/// lens. Throws Error(invalid_input) if the file is damaged or was not traced from `scene`. Throws
/// Error(out_of_memory) if the memory does not suffice.
/// @param frame The sample file, or the picture of another program.
/// @param settings Lens and method.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The picture, the lens that was used, and the error.
[[nodiscard]] FocusResult focus(const Frame& frame, const FocusSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
