/// @file
/// Pictures in memory and in files, and the positions, crops and exposure times of settings.
#pragma once

#include <filesystem>
#include <optional>
#include <postlens/job.h>
#include <string>
#include <utility>
#include <vector>

namespace postlens::api {

/// Width and height of a raster.
struct Size {
    int width = 0;   ///< px, 1 to 65536.
    int height = 0;  ///< px, 1 to 65536.
};

/// A position on the raster of a picture. Pixel i covers i to i + 1; (0, 0) is the upper left corner.
struct Position {
    double x = 0;  ///< px, to the right.
    double y = 0;  ///< px, down.
};

/// A part of a picture: the pixels from `x` to `x + width` and from `y` to `y + height`.
struct Crop {
    int x = 0;       ///< First column, px, from the left.
    int y = 0;       ///< First row, px, from the top.
    int width = 0;   ///< px, at least 1.
    int height = 0;  ///< px, at least 1.
};

/// The exposure time. Times are on the scene's clock. For a picture with motion vectors, the unit is a frame
/// instead: 0 is this frame, 1 the next one.
struct Shutter {
    double open_s = 0;  ///< The shutter opens, s.
    /// Instant at which the shutter closes, s; not before `open_s`. Equal times are a single instant.
    double close_s = 0;
};

/// A further channel of a picture.
struct Plane {
    std::string name = {};  ///< Name of the channel in an .exr file.
    std::vector<float> values =
        {};  ///< One value per pixel, rows from the top. The values are not multiplied by the exposure.
};

/// A picture in memory. Rows are stored from top to bottom, pixels of a row from left to right.
struct Picture {
    int width = 0;   ///< px.
    int height = 0;  ///< px.
    /// Red, green and blue of each pixel, 3 * width * height values. They are scene-linear with Rec. 709
    /// primaries, not clamped, and equal radiance times 2^exposure_stops, where 1 is white. If there is
    /// alpha, they are premultiplied by it.
    std::vector<float> rgb = {};
    /// Coverage of each pixel, 0 to 1, width * height values. If empty, every pixel is opaque.
    std::vector<float> alpha = {};
    /// Exposure of `rgb` in stops. Empty if it is not known, as for a PNG file of another program.
    std::optional<double> exposure_stops = 0.0;
    /// Further channels, such as those of `focus` with `--passes`. Only .exr files contain them.
    std::vector<Plane> planes = {};
    /// Texts that describe `planes`, by name, for example the manifest of a Cryptomatte.
    std::vector<std::pair<std::string, std::string>> texts = {};
};

/// Reads a picture as scene-linear values from any file that OpenImageIO reads: .exr, .png, .tif, .jpg and
/// others. Integers and values tagged sRGB are converted. If a file has one or two channels, the first
/// channel is read as grey. Alpha and further channels are not read. For a sample file, the result is its
/// pinhole picture.
///
/// Throws Error(invalid_input) if the file is missing, is damaged or contains no picture.
/// @param path The file.
/// @param job Threads, progress and cancellation; null: a thread per core.
/// @return The picture.
[[nodiscard]] Picture load_picture(const std::filesystem::path& path, Job* job = nullptr);

/// Writes a picture in the format that the file extension selects. An .exr file contains float radiance with
/// alpha and planes. A .png (8 bit), .tif (16 bit) or .jpg file contains sRGB values clamped to 0 to 1,
/// without alpha and planes.
///
/// Throws Error(wrong_arguments) for another extension and for vectors whose sizes do not match `width` and
/// `height`. Throws Error(cannot_write) if the file cannot be written.
/// @param path The file to write; an older file is replaced.
/// @param picture The picture.
/// @param job Threads, progress and cancellation; null: a thread per core.
void save_picture(const std::filesystem::path& path, const Picture& picture, Job* job = nullptr);

}  // namespace postlens::api
