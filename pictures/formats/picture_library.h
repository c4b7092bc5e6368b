// Interface to OpenImageIO, which reads and writes image formats other than OpenEXR and PNG. Only the
// implementation of this interface includes OpenImageIO.
//
// Debian's OpenImageIO depends on two hundred libraries, which take 0.3 s to load. The programs of this
// project therefore load it only when they need it (loaded_picture_library.cpp). Programs that use the
// installed libraries of this project link OpenImageIO directly (linked_picture_library.cpp). The choice is
// made by linking one of these two files.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace postlens {

/// The contents of a file's header. Members that begin with `full_` describe the display window.
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
    /// Integer values are scaled to 0..1. Returns an error message; empty on success.
    [[nodiscard]] virtual std::string read(int channels, float* to) = 0;
};

/// An image library. The library and its readers throw only std::bad_alloc. Other errors are returned as
/// texts, which may have several lines.
class PictureLibrary {
  public:
    PictureLibrary() = default;
    virtual ~PictureLibrary() = default;
    PictureLibrary(const PictureLibrary&) = delete;
    PictureLibrary& operator=(const PictureLibrary&) = delete;
    PictureLibrary(PictureLibrary&&) = delete;
    PictureLibrary& operator=(PictureLibrary&&) = delete;

    /// Opens a file for reading. If that fails, returns null and sets `problem`.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(const std::string& path,
                                                              std::string& problem) const = 0;
    /// Opens a file that is in memory and has the format `format`. The bytes must outlive the reader.
    [[nodiscard]] virtual std::unique_ptr<PictureReader> open(std::string_view bytes,
                                                              const std::string& format,
                                                              std::string& problem) const = 0;
    /// Returns a TIFF file with width * height * 3 sRGB values, where 65535 means 1; jpeg() returns a JPEG
    /// file, where 255 means 1. `description` is stored as text if it is not empty. On failure, returns an
    /// empty vector and sets `problem`.
    [[nodiscard]] virtual std::vector<unsigned char> tiff(int width, int height,
                                                          std::span<const std::uint16_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
    [[nodiscard]] virtual std::vector<unsigned char> jpeg(int width, int height,
                                                          std::span<const std::uint8_t> rgb,
                                                          const std::string& description,
                                                          std::string& problem) const = 0;
};

/// Returns the image library. Throws Error(invalid_input) if the library cannot be loaded. Several threads
/// may call this at the same time.
[[nodiscard]] const PictureLibrary& picture_library();

/// Name of the header attribute of a crop. It states the crop's x, y, width and height within the whole
/// image.
inline constexpr const char* crop_attribute = "postlens.crop";
/// Header attribute of any image: its exposure (pictures/image.h). In TIFF and JPEG it is part of the
/// description, as "postlens.exposure_stops=STOPS".
inline constexpr const char* exposure_attribute = "postlens.exposure_stops";
/// Header attribute of images and sample files: how they were made. In TIFF and JPEG it is a line of the
/// description, "postlens.made_by=TEXT".
inline constexpr const char* made_by_attribute = "postlens.made_by";

}  // namespace postlens
