/// @file
/// Makes the pictures of a sample file for many lenses and shutters.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/picture.h>
#include <string>
#include <vector>

namespace postlens::api {

/// Settings of `sweep`. The first five members are lists of values, and `sweep` makes one picture for every
/// combination of them. If one of the first three lists is empty, the value in the file is used. In the order
/// of the pictures, the focus distance changes fastest, followed by the f-number, the focal length, the
/// shutter and the impulse response.
struct SweepSettings {
    std::vector<double> f_number = {};  ///< F-numbers, more than 0. Infinity means a pinhole (`--f-number`).
    std::vector<double> focal_length_mm = {};   ///< Focal lengths, mm, more than 0 (`--focal-length`).
    std::vector<double> focus_distance_m = {};  ///< Focus distances, m. They may be infinite (`--focus`).
    std::vector<Shutter> shutter = {};          ///< Exposure times (`--shutter`). Default: no shutter.
    /// Impulse responses (images of a point that is out of focus) for which pictures are made (`--impulse`).
    /// Each is a text, for example "disc". `LensSettings::impulse` lists the possible texts.
    std::vector<std::string> impulse = {};
    /// As in `FocusSettings` (`--method`). Default with `shutter`: "lightfield".
    std::string method = {};
    std::optional<int> views = {};  ///< Lens points of lightfield and hybrid (`--views`).
    std::string format = {};        ///< "exr" (default), "png", "tif" or "jpg" (`--format`).
    bool resume = false;            ///< Keeps pictures of an earlier run with the same settings (`--resume`).
    std::optional<double> exposure = {};  ///< In stops, -100 to 100 (`--exposure`). Default: the file's.
    /// Further options of `postlens sweep`, for example {"--frames=pull.%04d.png"}.
    std::vector<std::string> options = {};
};

/// One picture of a sweep.
struct SweepPicture {
    std::filesystem::path file = {};      ///< The picture, within the folder of the sweep.
    double focal_length_mm = 0;           ///< Focal length, mm.
    double f_number = 0;                  ///< F-number; infinite for a pinhole.
    double focus_distance_m = 0;          ///< Focus distance, m. It may be infinite.
    std::optional<Shutter> shutter = {};  ///< Exposure time.
    std::string impulse = {};             ///< Impulse response (image of a point out of focus).
    std::string method = {};              ///< Method that was used.
    double largest_coc_px = 0;  ///< Diameter of the widest circle of confusion, px. It may be infinite.
    double in_focus_share = 0;  ///< Fraction of the pixels that are in focus, 0 to 1.
};

/// What `sweep` has made.
struct SweepResult {
    std::vector<SweepPicture> pictures = {};  ///< The pictures, in the order that `SweepSettings` describes.
    int made = 0;                             ///< Number of pictures that this call has made.
    int kept = 0;                             ///< Number of pictures of an earlier run that were kept.
    Report report = {};                       ///< Report of `postlens sweep`.
};

/// Makes a picture of the sample file `frame` for every combination of the settings. Writes the pictures, a
/// table (sweep.csv, sweep.json) and a contact sheet to the folder `output`. The folder is created if it does
/// not exist.
///
/// Throws Error(wrong_arguments) for a wrong setting, Error(invalid_input) for an invalid file,
/// Error(cannot_write) if a file cannot be written, and Error(out_of_memory) if the memory does not suffice.
/// Pictures that were completed before the error remain. A later call with `resume` keeps them.
/// @param frame The sample file.
/// @param output The folder.
/// @param settings The values to combine.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The pictures, with the lens settings and properties of each.
SweepResult sweep(const std::filesystem::path& frame, const std::filesystem::path& output,
                  const SweepSettings& settings, Job* job = nullptr);

}  // namespace postlens::api
