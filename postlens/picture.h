/// @file
/// Pictures in memory and in files, and the types of positions, crops and exposure times in settings.
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

/// A position on the raster of a picture. Pixel i extends from i to i + 1. The upper left corner of the
/// picture is (0, 0).
struct Position {
    double x = 0;  ///< px, to the right.
    double y = 0;  ///< px, down.
};

/// A rectangular part of a picture, given by its upper left pixel and its size.
struct Crop {
    int x = 0;       ///< First column, px, from the left.
    int y = 0;       ///< First row, px, from the top.
    int width = 0;   ///< px, at least 1.
    int height = 0;  ///< px, at least 1.
};

/// The exposure time: the interval in which the shutter is open, as times of the scene. A picture with motion
/// vectors has no scene. For such a picture, times are in frames instead of seconds: 0 is this frame and 1 is
/// the next one.
struct Shutter {
    double open_s = 0;  ///< Instant at which the shutter opens, s.
    /// Instant at which the shutter closes, in s, not before `open_s`. If the two are equal, the exposure is
    /// a single instant.
    double close_s = 0;
};

/// A further channel of a picture.
struct Plane {
    std::string name = {};  ///< Name of the channel in an .exr file.
    std::vector<float> values =
        {};  ///< One value per pixel, by rows from the top. The exposure does not change them.
};

/// A picture in memory. Rows are stored from top to bottom, and the pixels of a row from left to right.
struct Picture {
    int width = 0;   ///< px.
    int height = 0;  ///< px.
    /// Red, green and blue of each pixel, 3 * width * height values. They are scene-linear with Rec. 709
    /// primaries and not clamped. A value is the radiance times 2^exposure_stops, and 1 is white. If there is
    /// alpha, the values are premultiplied.
    std::vector<float> rgb = {};
    /// Coverage of each pixel from 0 to 1, width * height values. If this is empty, every pixel is opaque.
    std::vector<float> alpha = {};
    /// Exposure of the colours `rgb`, in stops: they are the radiance times 2^exposure_stops. It is empty if
    /// it is not known, as for a PNG file of another program.
    std::optional<double> exposure_stops = 0.0;
    /// Additional channels, such as those that `focus` computes for `--passes`. Only .exr files contain them.
    std::vector<Plane> planes = {};
    /// Named texts that describe the additional channels, `planes`. For example, the manifest of a
    /// Cryptomatte lists the names of its objects.
    std::vector<std::pair<std::string, std::string>> texts = {};
};

/// Reads a picture from any file that OpenImageIO reads: .exr, .png, .tif, .jpg and others. The result is
/// scene-linear. Integers, and values that are tagged as sRGB, are converted. If a file has one or two
/// channels, the first channel is read as grey. Alpha and additional channels are not read. For a sample
/// file, the result is its pinhole picture.
///
/// Throws Error(invalid_input) if the file is missing or damaged, or contains no picture.
/// @param path The file.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
/// @return The picture.
[[nodiscard]] Picture load_picture(const std::filesystem::path& path, Job* job = nullptr);

/// Writes a picture. The file extension selects the format. An .exr file contains radiance as floats, with
/// alpha and planes. A .png (8 bit), .tif (16 bit) or .jpg file contains sRGB values clamped to 0 to 1,
/// without alpha and planes.
///
/// Throws Error(wrong_arguments) if the extension is not supported, or if the size of a vector does not match
/// `width` and `height`. Throws Error(cannot_write) if the file cannot be written.
/// @param path The file to write. An existing file is replaced.
/// @param picture The picture.
/// @param job Threads, progress and cancellation. If null, the call uses one thread per core.
void save_picture(const std::filesystem::path& path, const Picture& picture, Job* job = nullptr);

}  // namespace postlens::api
