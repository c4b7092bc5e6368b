// An RGB picture in memory, and its way to and from image files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace postlens {

/// Row-major, top row first, three floats a pixel, Rec.709 primaries, linear, not clamped: 1 is white. Where
/// there is an alpha the colours are premultiplied by it.
struct Image {
    int width = 0, height = 0;
    std::vector<float> rgb;
    std::vector<float> alpha;  ///< one a pixel; empty: opaque
    /// `rgb` is radiance times 2^exposure_stops. Nothing: not known, as of another program's PNG, TIFF or
    /// JPEG.
    std::optional<double> exposure_stops = 0.0;

    Image() = default;
    Image(int w, int h)
        : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3, 0.0F) {}
    [[nodiscard]] float* pixel(int x, int y) {
        return rgb.data() +
               (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                   3;
    }
    [[nodiscard]] const float* pixel(int x, int y) const { return const_cast<Image*>(this)->pixel(x, y); }
};

/// A part of a picture: pixels [x, x + width) x [y, y + height), (0, 0) at its upper left (records/crop.h).
struct Crop {
    int x = 0, y = 0, width = 0, height = 0;
    [[nodiscard]] bool operator==(const Crop&) const = default;
    [[nodiscard]] bool contains(int px, int py) const {
        return px >= x && px < x + width && py >= y && py < y + height;
    }
    /// Whether a rectangle of the picture has a pixel of it.
    [[nodiscard]] bool meets(int px, int py, int w, int h) const {
        return px < x + width && x < px + w && py < y + height && y < py + h;
    }
};

/// Writes by the target's ending: .exr float and radiance, with alpha; .png (8 bit), .tif, .jpg with the
/// sRGB transfer curve, clamped to 0..1, without alpha (premultiplied colours are those over black). The file
/// appears whole or not at all. All keep the exposure as `postlens.exposure_stops`: .exr, where it is not 0,
/// as an attribute; the others, where it is known, in their text, beside values to which it has been applied.
/// With a `crop` only that part of the picture is written; an .exr says where in the whole it lies: its data
/// window is the crop, its display window the whole picture, and `postlens.crop` tells `read_image` that
/// there is no more to it. Returns XXH3 (64 bits) of the file's bytes. Throws Error(cannot_write) on any
/// failure and Error(wrong_arguments) for an ending that no writer knows and a crop that is not within the
/// picture.
std::uint64_t write_image(const std::filesystem::path& path, const Image& image,
                          const std::optional<Crop>& crop = std::nullopt);

/// Throws Error(wrong_arguments) where `write_image` would refuse the path, before any work is done; and
/// Error(invalid_input) where what writes it cannot be loaded (picture_library.h).
void check_image_path(const std::filesystem::path& path);
/// The same for files that are written as OpenEXR alone; `what` they hold: "records", "responses".
void check_exr_path(const std::filesystem::path& path, const char* what);

struct ImageSize {
    int width = 0, height = 0;
    [[nodiscard]] bool operator==(const ImageSize&) const = default;
};

/// The size that `read_image` would give, from the header alone. Throws Error(invalid_input).
[[nodiscard]] ImageSize read_image_size(const std::filesystem::path& path);

/// What an OpenEXR file of an exposure is read as.
enum class PictureValues {
    exposed,  ///< radiance times 2^postlens.exposure_stops: 1 is white
    stored    ///< radiance, as textures and apertures are
};

/// Reads the first three channels (one or two channels: the first is grey) of any file OpenImageIO knows, of
/// a file of several parts the first; integer formats and formats tagged sRGB are made scene-linear. The
/// picture is what the display window shows: pixels outside of it are left out, those that the file does not
/// store are black. Of a crop (see write_image) it is the crop alone. Throws Error(invalid_input).
[[nodiscard]] Image read_image(const std::filesystem::path& path,
                               PictureValues values = PictureValues::exposed);

}  // namespace postlens
