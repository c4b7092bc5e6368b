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
    /// "scatter", "layers", "lightfield", "hybrid", "auto" or "pinhole" (`--method`). Default: "auto", which
    /// is the usual method for what the file holds, or with `scene` or `target_db` as many views and rays as
    /// the target needs.
    std::string method = {};
    /// Lens points from which lightfield and hybrid reproject the records (`--views`). Default: 64.
    std::optional<int> views = {};
    /// Number of impulse responses of scatter and layers, 2 to 4096 (`--depths`). Default: as many as keep
    /// the circle of confusion right to half a pixel.
    std::optional<int> depths = {};
    /// PSNR that "auto" aims at, dB, 10 to 80 (`--target-db`).
    std::optional<double> target_db = {};
    /// The scene that the frame was traced from (`--scene`). Rays replace view samples where the records do
    /// not suffice, and the error is measured.
    std::filesystem::path scene = {};
    std::optional<Crop> crop = {};        ///< Makes only this part (`--crop`).
    std::optional<double> exposure = {};  ///< Stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further channels of a picture of another program (`--passes`): "coc", "sides", "cryptomatte", "error".
    std::vector<std::string> passes = {};
    /// Further options of `postlens focus`, for example {"--depth-model=path", "--exposure=auto"}.
    std::vector<std::string> options = {};
};

/// What `focus` and `shoot` have made.
struct FocusResult {
    /// Cut to the crop. Empty if `options` have an `--output`, to which the picture is written instead.
    Picture picture = {};
    std::string method = {};      ///< Method that was used.
    double focal_length_mm = 0;   ///< Focal length that was used, mm.
    double f_number = 0;          ///< F-number that was used; infinite for a pinhole.
    double focus_distance_m = 0;  ///< Focus distance that was used, m; may be infinite.
    /// Diameter of the widest circle of confusion, px; may be infinite. `shoot` does not state it.
    std::optional<double> largest_coc_px = {};
    /// PSNR against the exact picture, dB, as measured with rays while the picture was made. Empty without
    /// `scene`. Infinite if no error was found.
    std::optional<double> stated_db = {};
    std::optional<double> stated_low_db = {};   ///< Lower end of the 95 % interval of `stated_db`, dB.
    std::optional<double> stated_high_db = {};  ///< Upper end of the 95 % interval of `stated_db`, dB.
    Report report = {};                         ///< Of `postlens focus` or `postlens shoot`.
};

/// Makes the picture of a frame through a lens, with the bits that `postlens focus` writes. An infinite
/// f-number gives the pinhole picture. docs/focus.md states formulas, methods and limits [Potmesil &
/// Chakravarty 1981].
///
/// Throws Error(wrong_arguments) for a setting and where neither settings nor file define the lens,
/// Error(invalid_input) for a damaged file or another scene, Error(out_of_memory).
/// @param frame The sample file, or the picture of another program.
/// @param settings Lens and method.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return Picture and figures.
[[nodiscard]] FocusResult focus(const Frame& frame, const FocusSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
