// Interface to OpenImageIO, which reads and writes all image formats except OpenEXR and PNG.
//
// OpenImageIO can depend on two hundred other libraries and take 0.3 s to load. So the programs of this
// project load it only when they need it (loaded_picture_library.cpp). Other programs link it
// (linked_picture_library.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace postlens {

/// The contents of an image header. Members that begin with `full_` describe the display window. x, y, width
/// and height describe the data window.
struct PictureLayout {
    int width = 0, height = 0, depth = 0;
    int x = 0, y = 0;
    int full_x = 0, full_y = 0, full_width = 0, full_height = 0;
    std::vector<std::string> channels;
    std::string format;        ///< name of the format in OpenImageIO, such as "png"
    std::string colour_space;  ///< "sRGB", "Linear", or another name; empty if unknown
    std::string crop;          ///< see pictures/image.h; empty if there is none
    std::string exposure;      ///< postlens.exposure_stops as text; empty if there is none
    std::string made_by;       ///< postlens.made_by; empty if there is none
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
    /// Reads the first `channels` channels of all pixels into `to`, row by row. Integers are scaled to 0..1.
    /// Returns an error message, or "" on success.
    [[nodiscard]] virtual std::string read(int channels, float* to) = 0;
};

/// Interface to a library, OpenImageIO, that reads and writes image files. The library throws only
/// std::bad_alloc. It returns other errors as text of one or more lines.
class PictureLibrary {
  public:
    PictureLibrary() = default;
    virtual ~PictureLibrary() = default;
    PictureLibrary(const PictureLibrary&) = delete;
    PictureLibrary& operator=(const PictureLibrary&) = delete;
    PictureLibrary(PictureLibrary&&) = delete;
    PictureLibrary& operator=(PictureLibrary&&) = delete;

    /// Opens a file for reading. On failure, sets `problem` and returns null.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(const std::string& path,
                                                              std::string& problem) const = 0;
    /// Opens an encoded file in memory. `bytes` must outlive the reader. `format` is a file extension such as
    /// "png".
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(std::string_view bytes,
                                                              const std::string& format,
                                                              std::string& problem) const = 0;
    /// Encodes `rgb`, width * height * 3 sRGB values of 16 bits, as a TIFF file. On failure, sets `problem`
    /// and returns an empty vector.
    [[nodiscard]] virtual std::vector<unsigned char> tiff(int width, int height,
                                                          std::span<const std::uint16_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
    [[nodiscard]] virtual std::vector<unsigned char> jpeg(int width, int height,
                                                          std::span<const std::uint8_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
};

/// Returns the library that reads and writes image files. It is loaded at the first call. Throws
/// Error(invalid_input) if it cannot be loaded. Several threads may call this function at the same time.
[[nodiscard]] const PictureLibrary& picture_library();

/// Header attribute of a crop: its x, y, width and height in the whole image.
inline constexpr const char* crop_attribute = "postlens.crop";
/// Header attribute for the exposure of an image, in stops (pictures/image.h). In TIFF and JPEG files, it is
/// a line of the image description.
inline constexpr const char* exposure_attribute = "postlens.exposure_stops";
/// Header attribute that states how an image or a sample file was made. In TIFF and JPEG files, it is a line
/// of the image description.
inline constexpr const char* made_by_attribute = "postlens.made_by";

}  // namespace postlens
