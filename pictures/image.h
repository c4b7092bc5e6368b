// RGB images in memory, and functions that read and write image files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/new_memory.h"

namespace postlens {

/// An RGB image with three floats per pixel, row by row, top row first. Values are linear and not clamped,
/// with Rec.709 primaries. 1 is white. Colours are premultiplied by alpha.
struct Image {
    int width = 0, height = 0;
    std::vector<float> rgb;
    std::vector<float> alpha;  ///< one value per pixel; empty if the image is opaque
    /// Exposure of the image, in stops: the values in `rgb` are the radiance times 2^exposure_stops. It is
    /// empty if the exposure is unknown. This is so for 8-bit and 16-bit files of other programs.
    std::optional<double> exposure_stops = 0.0;
    /// An additional channel with one value per pixel, which is not scaled by the exposure.
    struct Plane {
        std::string name;
        std::vector<float> values;
    };
    std::vector<Plane> planes;                               ///< only .exr files have them
    std::vector<std::pair<std::string, std::string>> texts;  ///< attributes that belong to `planes`
    std::string made_by;  ///< how the image was made; stored in its file if not empty

    Image() = default;
    Image(int w, int h) : width(w), height(h) {
        resize_by_all(rgb, static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3);
    }
    [[nodiscard]] float* pixel(int x, int y) {
        return rgb.data() +
               (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                   3;
    }
    [[nodiscard]] const float* pixel(int x, int y) const { return const_cast<Image*>(this)->pixel(x, y); }
};

/// A rectangular part of an image: the pixels [x, x + width) x [y, y + height), counted from the upper left
/// pixel. See pictures/crop.h.
struct Crop {
    int x = 0, y = 0, width = 0, height = 0;
    [[nodiscard]] bool operator==(const Crop&) const = default;
    [[nodiscard]] bool contains(int px, int py) const {
        return px >= x && px < x + width && py >= y && py < y + height;
    }
    [[nodiscard]] bool meets(int px, int py, int w, int h) const {
        return px < x + width && x < px + w && py < y + height && y < py + h;
    }
};

/// Writes an image in the format given by the extension of the path: .exr (float radiance, with alpha), .png
/// (8 bit), .tif or .jpg. The last three formats use the sRGB transfer curve and clamp values to 0..1. They
/// have no alpha, so the image appears over black. The file appears completely or not at all.
///
/// The exposure is stored as `postlens.exposure_stops`. In .exr it is an attribute, which is omitted if the
/// exposure is 0. The other formats contain values multiplied by the exposure. They store the exposure as
/// text, unless it is unknown. A `made_by` that is not empty is stored as `postlens.made_by`, as an attribute
/// or as text.
///
/// With a `crop`, only that part is written. In .exr, the crop is then the data window and the whole image is
/// the display window. The attribute `postlens.crop` makes `read_image` return only the crop.
///
/// Returns the XXH3 hash (64 bits) of the file. Throws Error(cannot_write) on any failure to write. Throws
/// Error(wrong_arguments) for an unknown extension and for a crop that is not inside the image.
std::uint64_t write_image(const std::filesystem::path& path, const Image& image,
                          const std::optional<Crop>& crop = std::nullopt);

/// Checks an output path before the image is computed. Throws Error(wrong_arguments) if `write_image` does
/// not accept the path. Throws Error(invalid_input) if the format's library cannot be loaded.
void check_image_path(const std::filesystem::path& path);
/// Throws Error(wrong_arguments) unless a path has the extension .exr. The error message states that `what`,
/// for example "records", needs this extension.
void check_exr_path(const std::filesystem::path& path, const char* what);

struct ImageSize {
    int width = 0, height = 0;
    [[nodiscard]] bool operator==(const ImageSize&) const = default;
};

/// Returns the size of the image that `read_image` would return. Reads only the header. Throws
/// Error(invalid_input).
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path);

/// Returns the text that states how an image or a sample file was made (`made_by`), or an empty text. Throws
/// Error(invalid_input).
[[nodiscard]] std::string read_made_by(const std::filesystem::path& path);

/// Which values `read_image` returns for an OpenEXR file that states an exposure.
enum class PictureValues {
    exposed,  ///< returns radiance times 2^postlens.exposure_stops, so that 1 is white
    stored    ///< returns radiance, for textures and apertures
};

/// Reads the first part of a file: its first three channels, or a single channel as grey. Integers and sRGB
/// values become scene-linear.
///
/// The image covers the display window, or the crop if write_image cropped the file. Pixels without values
/// are black. Throws Error(invalid_input).
[[nodiscard]] Image read_image(const std::filesystem::path& path,
                               PictureValues values = PictureValues::exposed);

}  // namespace postlens
