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
    /// "scatter", "layers", "lightfield", "hybrid", "auto" or "pinhole" (`--method`). Default: "auto".
    /// Without `scene` and `target_db`, "auto" selects the usual method for the contents of the file. With
    /// either of them, it averages as many reprojections, and traces as many rays, as the target PSNR needs.
    std::string method = {};
    /// Number of lens points to which the methods "lightfield" and "hybrid" reproject the records
    /// (`--views`). Default: 64.
    std::optional<int> views = {};
    /// Number of impulse responses, one per depth, that the methods "scatter" and "layers" compute, 2 to 4096
    /// (`--depths`). Default: as many as are needed for circles of confusion that are accurate to half a
    /// pixel.
    std::optional<int> depths = {};
    /// Target PSNR of "auto", dB, 10 to 80 (`--target-db`).
    std::optional<double> target_db = {};
    /// The scene from which the frame was traced (`--scene`), for "hybrid" and "auto". Rays into the scene
    /// then replace samples that the records do not determine, and the error is measured.
    std::filesystem::path scene = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< Stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further channels of a picture of another program (`--passes`): "coc", "sides", "cryptomatte", "error".
    std::vector<std::string> passes = {};
    /// Further options of `postlens focus`, such as {"--depth-model=path", "--exposure=auto"}.
    std::vector<std::string> options = {};
};

/// What `focus` and `shoot` have made.
struct FocusResult {
    /// The picture, cut to the crop. Empty if `options` contain `--output`: the picture is then written to
    /// that file.
    Picture picture = {};
    std::string method = {};      ///< Method that was used.
    double focal_length_mm = 0;   ///< Focal length that was used, mm.
    double f_number = 0;          ///< F-number that was used; infinite for a pinhole.
    double focus_distance_m = 0;  ///< Focus distance that was used, m; may be infinite.
    /// Diameter of the widest circle of confusion, px; may be infinite. Not set by `shoot`.
    std::optional<double> largest_coc_px = {};
    /// PSNR against the exact picture, dB, measured with rays while the picture was made. Empty without
    /// `scene`. Infinite if the rays found no error.
    std::optional<double> stated_db = {};
    std::optional<double> stated_low_db = {};   ///< Lower end of the 95 % interval of `stated_db`, dB.
    std::optional<double> stated_high_db = {};  ///< Upper end of the 95 % interval of `stated_db`, dB.
    Report report = {};                         ///< Of `postlens focus` or `postlens shoot`.
};

/// Makes the picture of a frame through a lens. The result is bit-identical to that of `postlens focus`. For
/// an infinite f-number it is the pinhole picture. docs/focus.md describes formulas, methods and limits
/// [Potmesil & Chakravarty 1981].
///
/// Throws Error(wrong_arguments) for a wrong setting, or if neither the settings nor the file define the
/// lens. Throws Error(invalid_input) for a damaged file or another scene, and Error(out_of_memory).
/// @param frame The sample file, or the picture of another program.
/// @param settings Lens and method.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return Picture and figures.
[[nodiscard]] FocusResult focus(const Frame& frame, const FocusSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
