#include "pictures/image.h"

#include <Imath/half.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/checksum.h"
#include "core/error.h"
#include "core/files/output_file.h"
#include "core/files/text_file.h"
#include "core/text.h"
#include "core/threads.h"
#include "pictures/crop.h"
#include "pictures/encoded_picture.h"
#include "pictures/exposure.h"
#include "pictures/exr/exr_attributes.h"
#include "pictures/exr/flat_exr.h"
#include "pictures/formats/picture_library.h"
#include "pictures/formats/plain_picture.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

enum class Format { exr, png, tiff, jpeg, unknown };

Format format_of(const fs::path& path) {
    const std::string ending = lower_case(path.extension().string());
    if (ending == ".exr") return Format::exr;
    if (ending == ".png") return Format::png;
    if (ending == ".tif" || ending == ".tiff") return Format::tiff;
    if (ending == ".jpg" || ending == ".jpeg") return Format::jpeg;
    return Format::unknown;
}

/// Interleaves the image's RGB and alpha.
std::vector<float> with_alpha(const Image& image) {
    std::vector<float> rgba(image.rgb.size() / 3 * 4);
    for (std::size_t i = 0; i < image.alpha.size(); ++i) {
        std::copy_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                    rgba.begin() + static_cast<std::ptrdiff_t>(4 * i));
        rgba[4 * i + 3] = image.alpha[i];
    }
    return rgba;
}

std::vector<std::uint16_t> encoded_16bit(const Image& image) {
    constexpr float greatest = std::numeric_limits<std::uint16_t>::max();
    std::vector<std::uint16_t> values(image.rgb.size());
    const std::size_t row_values = static_cast<std::size_t>(image.width) * 3;
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const float* from = image.rgb.data() + y * row_values;
        std::transform(from, from + row_values, values.data() + y * row_values, [](float v) {
            return static_cast<std::uint16_t>(std::lround(srgb_from_linear(v) * greatest));
        });
    });
    return values;
}

/// Position of a crop in the whole image. `crop` is empty for a whole image.
struct Place {
    std::optional<Crop> crop;
    int whole_width = 0, whole_height = 0;
};

std::uint64_t write_exr(const OutputFile& file, const Image& image, const Place& place) {
    // Many programs expect an OpenEXR image to have an alpha channel. If `image` has no alpha, it is opaque,
    // so an alpha of 1 is written for each pixel. It is stored in half floats, which represent 1 exactly and
    // need half the space.
    const std::vector<float> rgba = image.alpha.empty() ? std::vector<float>() : with_alpha(image);
    const std::vector<Imath::half> ones(rgba.empty() ? static_cast<std::size_t>(image.width) : 0,
                                        Imath::half(1.0F));
    const float* values = rgba.empty() ? image.rgb.data() : rgba.data();
    const int x = place.crop ? place.crop->x : 0, y = place.crop ? place.crop->y : 0;
    FlatExr exr;
    exr.display = {0, 0, place.whole_width - 1, place.whole_height - 1};
    exr.data = {x, y, x + image.width - 1, y + image.height - 1};
    for (std::size_t c = 0; c < 3; ++c)
        exr.channels.push_back({std::string(1, "RGB"[c]), ExrChannel::Type::float32, values + c});
    if (rgba.empty()) {
        exr.channels.push_back({"A", ExrChannel::Type::half, ones.data(), FlatExr::Channel::Layout::one_row});
    } else {
        exr.channels.push_back({"A", ExrChannel::Type::float32, values + 3});
    }
    for (const Image::Plane& p : image.planes) {
        exr.channels.push_back(
            {p.name, ExrChannel::Type::float32, p.values.data(), FlatExr::Channel::Layout::plane});
    }
    exr.texts = image.texts;
    if (!image.made_by.empty()) exr.texts.emplace_back(made_by_attribute, image.made_by);
    exr.pixel_bytes = (rgba.empty() ? 3 : 4) * sizeof(float);
    exr.row_bytes = exr.pixel_bytes * static_cast<std::size_t>(image.width);
    // RLE (run-length encoding) does not make float channels smaller, so the file is not compressed.
    exr.compression = ChunkCompression::none;
    if (const double stops = image.exposure_stops.value_or(0); stops != 0)
        exr.texts.emplace_back(exposure_attribute, fmt::format("{}", stops));
    if (place.crop) {
        exr.texts.emplace_back(crop_attribute, fmt::format("{},{},{},{}", x, y, image.width, image.height));
    }
    return write_flat_exr(file.temporary_path(), file.target().string(), exr).value();
}

std::uint64_t write_bytes(OutputFile& file, std::string_view bytes) {
    file.write(bytes);
    return checksum_of(bytes.data(), bytes.size());
}

std::uint64_t write_other(OutputFile& file, Format format, const Image& image) {
    if (format == Format::png)
        return write_bytes(file, png_file(encoded_8bit(image), file.target().string()));
    std::string problem;
    std::string description =
        image.exposure_stops ? fmt::format("{}={}", exposure_attribute, *image.exposure_stops) : "";
    if (!image.made_by.empty()) {
        description +=
            fmt::format("{}{}={}", description.empty() ? "" : "\n", made_by_attribute, image.made_by);
    }
    const std::vector<unsigned char> bytes =
        format == Format::tiff
            ? picture_library().tiff(image.width, image.height, encoded_16bit(image), description, problem)
            : picture_library().jpeg(image.width, image.height, encoded_8bit(image).rgb, description,
                                     problem);
    if (bytes.empty()) {
        fail(ExitCode::cannot_write, "{}: cannot write ({})", file.target().string(),
             reason_of(std::move(problem)));
    }
    return write_bytes(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

void check_image_path(const fs::path& path) {
    const Format format = format_of(path);
    if (format == Format::unknown) {
        fail(ExitCode::wrong_arguments,
             "{}: unknown kind of image (got ending \"{}\"; expected exr, png, tif or jpg)", path.string(),
             path.extension().string());
    }
    // The image library is loaded now, so that an error is reported before the image is computed.
    if (format == Format::tiff || format == Format::jpeg) (void)picture_library();
}

void check_exr_path(const fs::path& path, const char* what) {
    if (format_of(path) == Format::exr) return;
    fail(ExitCode::wrong_arguments, "{}: {} are written as OpenEXR (got ending \"{}\"; expected .exr)",
         path.string(), what, path.extension().string());
}

std::uint64_t write_image(const fs::path& path, const Image& image, const std::optional<Crop>& crop) {
    check_image_path(path);
    if (crop) check_crop(crop, image.width, image.height);
    const Format format = format_of(path);
    // libjpeg would end the process for a larger image.
    constexpr int most_jpeg_px = 65500;
    const int width = crop ? crop->width : image.width, height = crop ? crop->height : image.height;
    if (format == Format::jpeg && std::max(width, height) > most_jpeg_px) {
        fail(ExitCode::cannot_write,
             "{}: too large for JPEG (got {}x{} px; expected at most {} a side, or exr)", path.string(),
             width, height, most_jpeg_px);
    }
    OutputFile file(path);  // fails early if the file cannot be written
    // OpenEXR files store radiance, so the exposure is removed from the values.
    const bool divided = format == Format::exr && image.exposure_stops.value_or(0) != 0;
    Image part = crop || divided ? cut(image, crop) : Image();
    if (divided) {
        set_exposure(part, 0);
        part.exposure_stops = image.exposure_stops;
    }
    const Image& written = crop || divided ? part : image;
    const std::uint64_t checksum = format == Format::exr
                                       ? write_exr(file, written, {crop, image.width, image.height})
                                       : write_other(file, format, written);
    file.commit();
    return checksum;
}

namespace {

struct OpenedImage {
    std::unique_ptr<PictureReader> in;
    /// Rectangle of the file's pixels that is read: the display window, or for a cropped image its data
    /// window.
    int x = 0, y = 0, width = 0, height = 0;
};

OpenedImage open_image(const fs::path& path) {
    const std::string name = path.string();
    const std::uintmax_t bytes = check_regular_file(path);
    check_exr_headers(path);
    std::string problem;
    OpenedImage out{open_plain_picture(path)};
    if (!out.in) out.in = picture_library().open(name, problem);
    if (!out.in) fail(ExitCode::invalid_input, "{}: cannot read ({})", name, reason_of(std::move(problem)));
    const PictureLayout& spec = out.in->layout();
    if (spec.deep)
        fail(ExitCode::invalid_input, "{}: cannot read (got deep pixels; expected a flat image)", name);
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.channels.empty()) {
        fail(ExitCode::invalid_input, "{}: cannot read (got {}x{}x{} with {} channels; expected a picture)",
             name, spec.width, spec.height, spec.depth, spec.channels.size());
    }
    const bool has_display_window = spec.full_width > 0 && spec.full_height > 0 && spec.crop.empty();
    out.x = has_display_window ? spec.full_x : spec.x;
    out.y = has_display_window ? spec.full_y : spec.y;
    out.width = has_display_window ? spec.full_width : spec.width;
    out.height = has_display_window ? spec.full_height : spec.height;
    // A damaged header could cause a large allocation, so the image size is compared with the file size.
    // Deflate compresses by a factor of at most 1032.
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

/// Returns the image of the display window. Pixels that the file does not store are black.
Image in_display_window(const OpenedImage& file, const Image& stored, const std::string& name) {
    const PictureLayout& spec = file.in->layout();
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
    shown.exposure_stops = stored.exposure_stops;
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

std::string read_made_by(const fs::path& path) {
    return open_image(path).in->layout().made_by;
}

Image read_image(const fs::path& path, PictureValues values) {
    const OpenedImage file = open_image(path);
    const PictureLayout& spec = file.in->layout();
    const int channels = spec.channels.size() >= 3 ? 3 : 1;
    const bool srgb = spec.colour_space == "sRGB" || (!spec.floating_point && spec.colour_space != "Linear");
    Image image(spec.width, spec.height);
    // Grey values are read into the first third of the array, and then expanded to RGB in place.
    if (const std::string problem = file.in->read(channels, image.rgb.data()); !problem.empty())
        fail(ExitCode::invalid_input, "{}: cannot read ({})", path.string(), reason_of(problem));
    if (channels == 1) {
        for (std::size_t i = image.rgb.size() / 3; i-- > 0;) {
            const float grey = image.rgb[i];
            image.rgb[3 * i] = image.rgb[3 * i + 1] = image.rgb[3 * i + 2] = grey;
        }
    }
    if (srgb) std::transform(image.rgb.begin(), image.rgb.end(), image.rgb.begin(), linear_from_srgb);
    // The exposure of the pixels is known only if the file states it, or if its values are linear. In an sRGB
    // image, any radiance may have been mapped to white, which has the value 1.
    if (!spec.exposure.empty()) {
        const double stops = stops_of_text(spec.exposure, path.string());
        if (srgb || !spec.floating_point) {
            image.exposure_stops = stops;
        } else if (values == PictureValues::exposed) {
            set_exposure(image, stops);
        }
    } else if (srgb) {
        image.exposure_stops.reset();
    }
    const bool whole =
        spec.x == file.x && spec.y == file.y && spec.width == file.width && spec.height == file.height;
    return whole ? image : in_display_window(file, image, path.string());
}

}  // namespace postlens
