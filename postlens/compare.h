/// @file
/// Measures the error of a picture against its reference.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `compare`.
struct CompareSettings {
    /// A second render of the reference with independent noise (`--noise`). The difference between this
    /// render and the reference shows how noisy the reference is, and therefore how small an error can be
    /// measured.
    std::filesystem::path noise = {};
    /// The pinhole picture of the same scene (`--pinhole`). It shows which pixels the lens changes: those in
    /// which the reference differs from it. If it is given, the error is also computed for these pixels
    /// alone.
    std::filesystem::path pinhole = {};
    std::filesystem::path map = {};  ///< PNG file to write, with the error in colours (`--map`).
    std::filesystem::path side_by_side =
        {};  ///< PNG file to write, with both pictures and the map (`--side-by-side`).
    /// Exposure at which the pictures are compared, in stops from -100 to 100 (`--exposure`). Default: the
    /// exposure of the reference.
    std::optional<double> exposure = {};
    std::optional<double> fail_psnr_db = {};  ///< Smallest acceptable PSNR, dB, 0 or more (`--fail-psnr`).
    std::optional<double> fail_relmse = {};   ///< Greatest acceptable relMSE, 0 or more (`--fail-relmse`).
    std::optional<double> fail_flip = {};     ///< Greatest acceptable FLIP, 0 to 1 (`--fail-flip`).
    /// Further options of `postlens compare`, for example {"--flip-white=2"}.
    std::vector<std::string> options = {};
};

/// The error of a picture. docs/compare.md defines each measure.
struct CompareResult {
    double psnr_db = 0;  ///< Peak signal-to-noise ratio of the sRGB values, dB. Infinite for equal pictures.
    double rmse = 0;     ///< Root mean square error of the linear values.
    double relmse = 0;   ///< Mean of the relative squared error.
    double ssim = 0;     ///< Structural similarity, up to 1 for equal pictures.
    double flip = 0;     ///< FLIP, the difference that an observer sees: 0 (equal) to 1.
    bool identical = false;  ///< All values are equal.
    std::optional<double> affected_share =
        {};  ///< With `pinhole`: fraction of the pixels that the lens changes.
    std::optional<double> affected_psnr_db = {};  ///< With `pinhole`: PSNR of these pixels, dB.
    std::optional<double> noise_psnr_db = {};     ///< With `noise`: PSNR of the noisy reference, dB.
    Report report = {};                           ///< Report of `postlens compare`, with more measures.
};

/// Compares two picture files of the same size. For a sample file, its pinhole picture is compared.
///
/// Throws Error(invalid_input) if a file cannot be read or if the sizes differ. Throws Error(wrong_arguments)
/// for a wrong setting.
/// @param image The picture whose error is measured.
/// @param reference The picture that is taken to be correct.
/// @param settings Further pictures to read, limits of the error, and maps to write.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The error of `image`.
[[nodiscard]] CompareResult compare(const std::filesystem::path& image,
                                    const std::filesystem::path& reference,
                                    const CompareSettings& settings = {}, Job* job = nullptr);

/// Compares two pictures in memory, by writing them to temporary .exr files. Alpha and planes (additional
/// channels) are not compared. Throws the same errors as `compare` of two files, and Error(cannot_write) if a
/// temporary file cannot be written.
/// @param image The picture whose error is measured.
/// @param reference The picture that is taken to be correct.
/// @param settings Further pictures to read, limits of the error, and maps to write.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The error of `image`.
[[nodiscard]] CompareResult compare(const Picture& image, const Picture& reference,
                                    const CompareSettings& settings = {}, Job* job = nullptr);

}  // namespace postlens::api
