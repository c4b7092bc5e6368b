// Pictures of formats that are not our own, by way of OpenImageIO, which nothing else may include.
//
// Debian's OpenImageIO brings two hundred other libraries, which take the dynamic loader 0.3 s. The programs
// here therefore load it when they first need it (loaded_picture_library.cpp); programs that link the
// installed libraries link it (linked_picture_library.cpp). Which of the two is a question of linking.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace postlens {

/// What a file's header says. The display window is that of `full_`.
struct PictureLayout {
    int width = 0, height = 0, depth = 0;
    int x = 0, y = 0;
    int full_x = 0, full_y = 0, full_width = 0, full_height = 0;
    std::vector<std::string> channels;
    std::string format;        ///< by the library's name for it, such as "png"
    std::string colour_space;  ///< "sRGB", "Linear", or another's; empty: not known
    std::string crop;          ///< see records/image.h; empty: none
    std::string exposure;      ///< postlens.exposure_stops as text; empty: none
    bool deep = false;
    bool floating_point = false;  ///< its numbers are of a floating-point type
};

/// A picture file opened for reading; of a file of several parts the first.
class PictureReader {
  public:
    PictureReader() = default;
    virtual ~PictureReader() = default;
    PictureReader(const PictureReader&) = delete;
    PictureReader& operator=(const PictureReader&) = delete;
    PictureReader(PictureReader&&) = delete;
    PictureReader& operator=(PictureReader&&) = delete;

    [[nodiscard]] virtual const PictureLayout& layout() const = 0;
    /// The first `channels` channels of all pixels, row by row, into `to`, which has room for them; integers
    /// as 0 to 1. Returns what went wrong, or nothing.
    [[nodiscard]] virtual std::string read(int channels, float* to) = 0;
};

/// Nothing of it, nor of a reader, throws anything but std::bad_alloc. Errors are texts, which may have
/// several lines.
class PictureLibrary {
  public:
    PictureLibrary() = default;
    virtual ~PictureLibrary() = default;
    PictureLibrary(const PictureLibrary&) = delete;
    PictureLibrary& operator=(const PictureLibrary&) = delete;
    PictureLibrary(PictureLibrary&&) = delete;
    PictureLibrary& operator=(PictureLibrary&&) = delete;

    /// Null, and what went wrong, where it cannot be read.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(const std::string& path,
                                                              std::string& problem) const = 0;
    /// The same for the bytes of a file, which must stay where they are, of the format `format`.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(std::string_view bytes,
                                                              const std::string& format,
                                                              std::string& problem) const = 0;
    /// A TIFF file of width * height * 3 numbers, which are sRGB with 65535 for 1; likewise a JPEG file with
    /// 255 for 1. `description`: a text beside it, if not empty. Empty, and what went wrong, where that
    /// cannot be done.
    [[nodiscard]] virtual std::vector<unsigned char> tiff(int width, int height,
                                                          std::span<const std::uint16_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
    [[nodiscard]] virtual std::vector<unsigned char> jpeg(int width, int height,
                                                          std::span<const std::uint8_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
};

/// The one there is. Throws Error(invalid_input) where it has to be loaded and cannot be; safe to call from
/// several threads.
[[nodiscard]] const PictureLibrary& picture_library();

/// In the header of a crop: where it lies in the whole picture, x, y, width and height.
inline constexpr const char* crop_attribute = "postlens.crop";
/// In the header of any picture: its exposure (records/image.h). TIFF and JPEG have it in their description,
/// as "postlens.exposure_stops=STOPS".
inline constexpr const char* exposure_attribute = "postlens.exposure_stops";

}  // namespace postlens
