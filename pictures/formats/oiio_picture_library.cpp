#include "pictures/formats/oiio_picture_library.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <exception>
#include <new>
#include <utility>

namespace postlens {
namespace {

/// Returns the result of `work`, which calls a decoder or an encoder. If it throws, returns an empty result,
/// and `problem` is the message.
template <typename Work>
auto guarded(std::string& problem, const Work& work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        problem = e.what();
        return {};
    }
}

/// Returns a header attribute as text. TIFF and JPEG files store attributes as lines "NAME=TEXT" of the image
/// description.
std::string text_of(const OIIO::ImageSpec& s, const std::string& name) {
    if (const OIIO::ParamValue* found = s.find_attribute(name)) return found->get_string();
    std::string begin("\n"), text("\n");
    begin.append(name).append("=");
    text.append(std::string(s.get_string_attribute("ImageDescription")));
    const std::size_t at = text.find(begin);
    if (at == std::string::npos) return "";
    const std::size_t from = at + begin.size();
    return text.substr(from, text.find('\n', from) - from);
}

class OiioReader : public PictureReader {
  public:
    /// `memory` is the encoded file in memory, or null if `in` reads a file on disk.
    OiioReader(std::unique_ptr<OIIO::ImageInput> in,
               std::unique_ptr<OIIO::Filesystem::IOMemReader> memory = nullptr)
        : memory_(std::move(memory)), in_(std::move(in)) {
        const OIIO::ImageSpec& s = in_->spec();
        layout_ = {.width = s.width,
                   .height = s.height,
                   .depth = s.depth,
                   .x = s.x,
                   .y = s.y,
                   .full_x = s.full_x,
                   .full_y = s.full_y,
                   .full_width = s.full_width,
                   .full_height = s.full_height,
                   .channels = s.channelnames,
                   .format = in_->format_name(),
                   .colour_space = s.get_string_attribute("oiio:ColorSpace"),
                   .crop = s.get_string_attribute(crop_attribute),
                   .exposure = text_of(s, exposure_attribute),
                   .made_by = text_of(s, made_by_attribute),
                   .deep = s.deep,
                   .floating_point = s.format == OIIO::TypeDesc::FLOAT || s.format == OIIO::TypeDesc::HALF ||
                                     s.format == OIIO::TypeDesc::DOUBLE};
    }

    [[nodiscard]] const PictureLayout& layout() const override { return layout_; }

    [[nodiscard]] std::string read(int channels, float* to) override {
        std::string problem;
        const bool ok = guarded(problem, [&] {
            if (in_->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, to)) return true;
            problem = in_->geterror();
            return false;
        });
        return ok ? "" : problem.empty() ? "no reason given" : problem;
    }

  private:
    std::unique_ptr<OIIO::Filesystem::IOMemReader> memory_;
    std::unique_ptr<OIIO::ImageInput> in_;  // destroyed before memory_, from which it reads
    PictureLayout layout_;
};

/// Encodes an image file in memory. The caller then writes the bytes to the disk and checks for errors.
/// OpenImageIO 2.4 must not write to the disk itself, because on a full disk, it reports no error for PNG and
/// TIFF, and ends the process for JPEG.
std::vector<unsigned char> encode(const char* name, const OIIO::ImageSpec& spec, const void* values,
                                  std::string& problem) {
    return guarded(problem, [&]() -> std::vector<unsigned char> {
        OIIO::Filesystem::IOVecOutput memory;
        const auto out = OIIO::ImageOutput::create(name, &memory);
        if (out && out->open(name, spec) && out->write_image(spec.format, values) && out->close())
            return std::move(memory.buffer());
        problem = out ? out->geterror() : OIIO::geterror();
        return {};
    });
}

class OiioLibrary : public PictureLibrary {
  public:
    [[nodiscard]] std::unique_ptr<PictureReader> open(const std::string& path,
                                                      std::string& problem) const override {
        return guarded(problem, [&]() -> std::unique_ptr<PictureReader> {
            if (auto in = OIIO::ImageInput::open(path)) return std::make_unique<OiioReader>(std::move(in));
            problem = OIIO::geterror();
            return nullptr;
        });
    }

    [[nodiscard]] std::unique_ptr<PictureReader> open(std::string_view bytes, const std::string& format,
                                                      std::string& problem) const override {
        return guarded(problem, [&]() -> std::unique_ptr<PictureReader> {
            auto memory = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes.data(), bytes.size());
            auto in = OIIO::ImageInput::open("memory." + format, nullptr, memory.get());
            if (in) return std::make_unique<OiioReader>(std::move(in), std::move(memory));
            problem = OIIO::geterror();
            return nullptr;
        });
    }

    [[nodiscard]] std::vector<unsigned char> tiff(int width, int height, std::span<const std::uint16_t> rgb,
                                                  const std::string& description,
                                                  std::string& problem) const override {
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT16);
        // DateTime is left empty instead of stating the time, so that equal images give equal files. A colour
        // space is not written, because readers assume sRGB for integers.
        spec["DateTime"] = "";
        if (!description.empty()) spec["ImageDescription"] = description;
        return encode("picture.tif", spec, rgb.data(), problem);
    }

    [[nodiscard]] std::vector<unsigned char> jpeg(int width, int height, std::span<const std::uint8_t> rgb,
                                                  const std::string& description,
                                                  std::string& problem) const override {
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
        spec["oiio:ColorSpace"] = "sRGB";
        spec["compression"] = "jpeg:95";
        if (!description.empty()) spec["ImageDescription"] = description;
        return encode("picture.jpg", spec, rgb.data(), problem);
    }
};

}  // namespace

const PictureLibrary& oiio_picture_library() {
    static const OiioLibrary library;
    return library;
}

}  // namespace postlens
