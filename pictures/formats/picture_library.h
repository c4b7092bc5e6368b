// Interface to OpenImageIO, which reads and writes other image formats. No other code may include
// OpenImageIO.
//
// Debian's OpenImageIO depends on two hundred libraries, which the dynamic loader needs 0.3 s to load. The
// programs of this project therefore load it when they first need it (loaded_picture_library.cpp). Programs
// that link the installed libraries link it (linked_picture_library.cpp). The linked file decides which of
// the two is used.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace postlens {

/// Contents of a file's header. Members that begin with `full_` are the display window.
struct PictureLayout {
    int width = 0, height = 0, depth = 0;
    int x = 0, y = 0;
    int full_x = 0, full_y = 0, full_width = 0, full_height = 0;
    std::vector<std::string> channels;
    std::string format;        ///< name of the format in OpenImageIO, such as "png"
    std::string colour_space;  ///< "sRGB", "Linear", or another name; empty: unknown
    std::string crop;          ///< see pictures/image.h; empty: none
    std::string exposure;      ///< postlens.exposure_stops as text; empty: none
    std::string made_by;       ///< postlens.made_by; empty: none
    bool deep = false;
    bool floating_point = false;  ///< values have a floating-point type
};

/// An image file opened for reading. Only the first part of a multi-part file is read.
class PictureReader {
  public:
    PictureReader() = default;
    virtual ~PictureReader() = default;
    PictureReader(const PictureReader&) = delete;
    PictureReader& operator=(const PictureReader&) = delete;
    PictureReader(PictureReader&&) = delete;
    PictureReader& operator=(PictureReader&&) = delete;

    [[nodiscard]] virtual const PictureLayout& layout() const = 0;
    /// Reads the first `channels` channels of all pixels, row by row, into `to`, which must be large enough.
    /// Integers are scaled to 0..1. Returns an error message, empty on success.
    [[nodiscard]] virtual std::string read(int channels, float* to) = 0;
};

/// An image library. It and its readers throw nothing but std::bad_alloc. Errors are reported as texts, which
/// may have several lines.
class PictureLibrary {
  public:
    PictureLibrary() = default;
    virtual ~PictureLibrary() = default;
    PictureLibrary(const PictureLibrary&) = delete;
    PictureLibrary& operator=(const PictureLibrary&) = delete;
    PictureLibrary(PictureLibrary&&) = delete;
    PictureLibrary& operator=(PictureLibrary&&) = delete;

    /// Opens a file. Returns null and sets `problem` if it cannot be read.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(const std::string& path,
                                                              std::string& problem) const = 0;
    /// Opens the bytes of a file in the format `format`. The bytes must outlive the reader.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(std::string_view bytes,
                                                              const std::string& format,
                                                              std::string& problem) const = 0;
    /// Returns a TIFF file of width * height * 3 sRGB values, where 65535 stands for 1; for JPEG, 255 stands
    /// for 1. `description` is stored as text if not empty. Returns an empty vector and sets `problem` on
    /// failure.
    [[nodiscard]] virtual std::vector<unsigned char> tiff(int width, int height,
                                                          std::span<const std::uint16_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
    [[nodiscard]] virtual std::vector<unsigned char> jpeg(int width, int height,
                                                          std::span<const std::uint8_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
};

/// The image library. Throws Error(invalid_input) if it cannot be loaded. Several threads may call this at
/// once.
[[nodiscard]] const PictureLibrary& picture_library();

/// Header attribute of a crop: its x, y, width and height within the whole image.
inline constexpr const char* crop_attribute = "postlens.crop";
/// Header attribute of any image: its exposure (pictures/image.h). TIFF and JPEG have it in their
/// description, as "postlens.exposure_stops=STOPS".
inline constexpr const char* exposure_attribute = "postlens.exposure_stops";
/// Header attribute of images and sample files: how they were made. TIFF and JPEG have it in their
/// description, in a line of its own, as "postlens.made_by=TEXT".
inline constexpr const char* made_by_attribute = "postlens.made_by";

}  // namespace postlens
