#include "records/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/output_file.h"
#include "core/threads.h"
#include "records/crop.h"
#include "records/exr_attributes.h"
#include "records/srgb.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

enum class Format { exr, png, tiff, jpeg, unknown };

Format format_of(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".exr") return Format::exr;
    if (ending == ".png") return Format::png;
    if (ending == ".tif" || ending == ".tiff") return Format::tiff;
    if (ending == ".jpg" || ending == ".jpeg") return Format::jpeg;
    return Format::unknown;
}

/// OpenImageIO's messages may span lines; ours are one.
std::string one_line(std::string text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "no reason given" : text;
}

/// In the header of a crop: where it lies in the whole picture, x, y, width and height.
constexpr const char* crop_attribute = "postlens.crop";

/// RGB with the picture's alpha, or 1, as OpenEXR pictures are expected to have.
std::vector<float> with_alpha(const Image& image) {
    std::vector<float> rgba(image.rgb.size() / 3 * 4);
    for (std::size_t i = 0; i < image.rgb.size() / 3; ++i) {
        std::copy_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                    rgba.begin() + static_cast<std::ptrdiff_t>(4 * i));
        rgba[4 * i + 3] = image.alpha.empty() ? 1 : image.alpha[i];
    }
    return rgba;
}

/// Values of `Integer`, its greatest standing for 1.
template <typename Integer>
std::vector<Integer> encoded(const Image& image) {
    constexpr float greatest = std::numeric_limits<Integer>::max();
    std::vector<Integer> values(image.rgb.size());
    const std::size_t row_values = static_cast<std::size_t>(image.width) * 3;
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const float* from = image.rgb.data() + y * row_values;
        std::transform(from, from + row_values, values.data() + y * row_values, [](float v) {
            return static_cast<Integer>(std::lround(srgb_from_linear(v) * greatest));
        });
    });
    return values;
}

/// `place`: where in the whole picture the image lies, and how large that is.
struct Place {
    std::optional<Crop> crop;
    int whole_width = 0, whole_height = 0;
};

OIIO::ImageSpec spec_for(Format format, const Image& image, const Place& place) {
    const auto type = format == Format::exr    ? OIIO::TypeDesc::FLOAT
                      : format == Format::tiff ? OIIO::TypeDesc::UINT16
                                               : OIIO::TypeDesc::UINT8;
    OIIO::ImageSpec spec(image.width, image.height, format == Format::exr ? 4 : 3, type);
    // Not for TIFF, where it asks for an EXIF directory, which OpenImageIO 2.4 cannot write to memory.
    // Integer pixels are taken as sRGB without it.
    if (format != Format::tiff) spec["oiio:ColorSpace"] = format == Format::exr ? "Linear" : "sRGB";
    // A noisy 1920x1080 picture: RLE 0.17 s and 29 MB, ZIP 0.47 s and 24 MB.
    if (format == Format::exr) spec["compression"] = "rle";
    if (format == Format::jpeg) spec["compression"] = "jpeg:95";
    // Without one OpenImageIO adds the time of writing to OpenEXR and TIFF files: equal pictures would be
    // unequal files.
    if (format == Format::exr || format == Format::tiff) spec["DateTime"] = "";
    if (format == Format::exr && place.crop) {
        const Crop& c = *place.crop;
        spec.x = c.x;
        spec.y = c.y;
        spec.full_width = place.whole_width;
        spec.full_height = place.whole_height;
        spec[crop_attribute] = fmt::format("{},{},{},{}", c.x, c.y, c.width, c.height);
    }
    return spec;
}

bool write_pixels(OIIO::ImageOutput& out, Format format, const Image& image) {
    switch (format) {
        case Format::exr:
            return out.write_image(OIIO::TypeDesc::FLOAT, with_alpha(image).data());
        case Format::tiff:
            return out.write_image(OIIO::TypeDesc::UINT16, encoded<std::uint16_t>(image).data());
        default:
            return out.write_image(OIIO::TypeDesc::UINT8, encoded<std::uint8_t>(image).data());
    }
}

/// The whole file in memory: on a full disk OpenImageIO 2.4 reports success for PNG and TIFF and ends the
/// process for JPEG, so it is not the one to write to the disk.
std::vector<unsigned char> encode_file(const fs::path& path, Format format, const Image& image,
                                       const Place& place) {
    OIIO::Filesystem::IOVecOutput memory;
    const auto out = OIIO::ImageOutput::create(path.filename().string(), &memory);
    if (!out)
        fail(ExitCode::cannot_write, "{}: cannot write ({})", path.string(), one_line(OIIO::geterror()));
    const bool ok = out->open(path.filename().string(), spec_for(format, image, place)) &&
                    write_pixels(*out, format, image) && out->close();
    if (!ok) fail(ExitCode::cannot_write, "{}: cannot write ({})", path.string(), one_line(out->geterror()));
    return std::move(memory.buffer());
}

}  // namespace

void check_image_path(const fs::path& path) {
    if (format_of(path) == Format::unknown) {
        fail(ExitCode::wrong_arguments,
             "{}: unknown kind of image (got ending \"{}\"; expected exr, png, tif or jpg)", path.string(),
             path.extension().string());
    }
}

void check_exr_path(const fs::path& path, const char* what) {
    if (format_of(path) == Format::exr) return;
    fail(ExitCode::wrong_arguments, "{}: {} are written as OpenEXR (got ending \"{}\"; expected .exr)",
         path.string(), what, path.extension().string());
}

void write_image(const fs::path& path, const Image& image, const std::optional<Crop>& crop) {
    check_image_path(path);
    if (crop) check_crop(crop, image.width, image.height);
    OutputFile file(path);  // refuses what cannot be written before the work is done
    const std::vector<unsigned char> bytes = encode_file(
        path, format_of(path), crop ? cut(image, crop) : image, {crop, image.width, image.height});
    file.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

namespace {

struct OpenedImage {
    std::unique_ptr<OIIO::ImageInput> in;
    /// The display window, or a crop's data window, in the file's coordinates.
    int x = 0, y = 0, width = 0, height = 0;
};

OpenedImage open_image(const fs::path& path) {
    const std::string name = path.string();
    std::error_code ec;
    if (!fs::exists(path, ec)) fail(ExitCode::invalid_input, "{}: cannot read (no such file)", name);
    if (!fs::is_regular_file(path, ec)) {
        fail(ExitCode::invalid_input, "{}: cannot read (expected an image file)", name);
    }
    check_exr_headers(path);
    OpenedImage out{OIIO::ImageInput::open(name)};
    if (!out.in) fail(ExitCode::invalid_input, "{}: cannot read ({})", name, one_line(OIIO::geterror()));
    const OIIO::ImageSpec& spec = out.in->spec();
    if (spec.deep)
        fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat image)", name);
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1) {
        fail(ExitCode::invalid_input, "{}: cannot read (got {}x{}x{} with {} channels; expected a picture)",
             name, spec.width, spec.height, spec.depth, spec.nchannels);
    }
    const bool has_display_window =
        spec.full_width > 0 && spec.full_height > 0 && spec.get_string_attribute(crop_attribute).empty();
    out.x = has_display_window ? spec.full_x : spec.x;
    out.y = has_display_window ? spec.full_y : spec.y;
    out.width = has_display_window ? spec.full_width : spec.width;
    out.height = has_display_window ? spec.full_height : spec.height;
    // A damaged header must not ask for much memory. Deflate, the densest of the formats, packs 1 to 1032.
    const std::uint64_t bytes = fs::file_size(path, ec);
    const auto check_size = [&](int width, int height) {
        const std::uint64_t needed =
            static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * 3 * sizeof(float);
        constexpr std::uint64_t unquestioned = 256U << 20U;
        if (needed > unquestioned && needed / 4096 > bytes) {
            fail(ExitCode::invalid_input, "{}: header is damaged (got {}x{} pixels in {} bytes)", name, width,
                 height, bytes);
        }
    };
    check_size(spec.width, spec.height);
    check_size(out.width, out.height);
    return out;
}

/// The part of the stored pixels that the display window shows, black where it shows none.
Image in_display_window(const OpenedImage& file, const Image& stored, const std::string& name) {
    const OIIO::ImageSpec& spec = file.in->spec();
    const std::int64_t shift_x = std::int64_t{spec.x} - file.x, shift_y = std::int64_t{spec.y} - file.y;
    const std::int64_t x_begin = std::max<std::int64_t>(0, shift_x);
    const std::int64_t x_end = std::min<std::int64_t>(file.width, shift_x + spec.width);
    const std::int64_t y_begin = std::max<std::int64_t>(0, shift_y);
    const std::int64_t y_end = std::min<std::int64_t>(file.height, shift_y + spec.height);
    if (x_begin >= x_end || y_begin >= y_end) {
        fail(ExitCode::invalid_input,
             "{}: no pixels to see (the data window lies outside the display window)", name);
    }
    Image shown(file.width, file.height);
    for (std::int64_t y = y_begin; y < y_end; ++y) {
        std::copy_n(stored.pixel(static_cast<int>(x_begin - shift_x), static_cast<int>(y - shift_y)),
                    3 * (x_end - x_begin), shown.pixel(static_cast<int>(x_begin), static_cast<int>(y)));
    }
    return shown;
}

}  // namespace

ImageSize read_image_size(const fs::path& path) {
    const OpenedImage file = open_image(path);
    return {file.width, file.height};
}

Image read_image(const fs::path& path) {
    const OpenedImage file = open_image(path);
    const OIIO::ImageSpec& spec = file.in->spec();
    const int channels = spec.nchannels >= 3 ? 3 : 1;
    const bool is_float = spec.format == OIIO::TypeDesc::FLOAT || spec.format == OIIO::TypeDesc::HALF ||
                          spec.format == OIIO::TypeDesc::DOUBLE;
    const std::string colour_space = spec.get_string_attribute("oiio:ColorSpace");
    const bool srgb = colour_space == "sRGB" || (!is_float && colour_space != "Linear");
    Image image(spec.width, spec.height);
    // Grey values go to the front and are spread out below.
    if (!file.in->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, image.rgb.data())) {
        fail(ExitCode::invalid_input, "{}: cannot read ({})", path.string(), one_line(file.in->geterror()));
    }
    if (channels == 1) {
        for (std::size_t i = image.rgb.size() / 3; i-- > 0;) {
            const float grey = image.rgb[i];
            image.rgb[3 * i] = image.rgb[3 * i + 1] = image.rgb[3 * i + 2] = grey;
        }
    }
    if (srgb) std::transform(image.rgb.begin(), image.rgb.end(), image.rgb.begin(), linear_from_srgb);
    const bool whole =
        spec.x == file.x && spec.y == file.y && spec.width == file.width && spec.height == file.height;
    return whole ? image : in_display_window(file, image, path.string());
}

}  // namespace postlens
