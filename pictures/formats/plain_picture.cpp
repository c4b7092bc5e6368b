#include "pictures/formats/plain_picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <array>
#include <cstdint>
#include <exception>
#include <fmt/format.h>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "pictures/exr/exr_input.h"
#include "pictures/exr/library_threads.h"

namespace postlens {
namespace {

class ExrReader : public PictureReader {
  public:
    ExrReader(std::unique_ptr<Imf::MultiPartInputFile> file, PictureLayout layout)
        : file_(std::move(file)), layout_(std::move(layout)) {}

    [[nodiscard]] const PictureLayout& layout() const override { return layout_; }

    [[nodiscard]] std::string read(int channels, float* to) override {
        const auto count = static_cast<std::size_t>(channels);
        const std::size_t pixel_bytes = count * sizeof(float);
        const std::size_t row_bytes = pixel_bytes * static_cast<std::size_t>(layout_.width);
        // The OpenEXR library addresses pixels by their coordinates in the file, whose first pixel need not
        // be (0, 0).
        const std::ptrdiff_t shift = layout_.x * static_cast<std::ptrdiff_t>(pixel_bytes) +
                                     layout_.y * static_cast<std::ptrdiff_t>(row_bytes);
        try {
            Imf::FrameBuffer buffer;
            for (std::size_t c = 0; c < count; ++c) {
                buffer.insert(
                    layout_.channels[c],
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(to + c) - shift, pixel_bytes, row_bytes));
            }
            Imf::InputPart part(*file_, 0);
            part.setFrameBuffer(buffer);
            part.readPixels(layout_.y, layout_.y + layout_.height - 1);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& e) {
            return e.what();
        }
        return "";
    }

  private:
    std::unique_ptr<Imf::MultiPartInputFile> file_;
    PictureLayout layout_;
};

/// Returns the layout of a file with this header, or empty if open_plain_picture does not support it.
std::optional<PictureLayout> plain_layout(const Imf::Header& header) {
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE)
        return std::nullopt;
    // These attributes state a colour space, so the file's values may be nonlinear.
    for (const char* name : {"oiio:ColorSpace", "colorInteropID"}) {
        if (header.find(name) != header.end()) return std::nullopt;
    }
    PictureLayout out;
    const Imf::ChannelList& channels = header.channels();
    bool alpha = false;
    std::size_t count = 0;
    for (auto c = channels.begin(); c != channels.end(); ++c, ++count) {
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1 || c.channel().type == Imf::UINT)
            return std::nullopt;
        alpha = alpha || std::string_view(c.name()) == "A";
    }
    if (channels.findChannel("Y") != nullptr) {
        out.channels = {"Y"};
    } else {
        out.channels = {"R", "G", "B"};
    }
    for (const std::string& name : out.channels) {
        if (channels.findChannel(name) == nullptr) return std::nullopt;
    }
    if (alpha) out.channels.emplace_back("A");
    if (count != out.channels.size()) return std::nullopt;
    const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
    const auto extent = [](int from, int to) { return static_cast<std::int64_t>(to) - from + 1; };
    constexpr std::int64_t most = 1 << 26;
    for (const Imath::Box2i* box : {&data, &display}) {
        for (const int at : {box->min.x, box->min.y}) {
            if (at < -most || at > most) return std::nullopt;
        }
        for (const std::int64_t size : {extent(box->min.x, box->max.x), extent(box->min.y, box->max.y)}) {
            if (size < 1 || size > most) return std::nullopt;
        }
    }
    out.x = data.min.x;
    out.y = data.min.y;
    out.width = data.max.x - data.min.x + 1;
    out.height = data.max.y - data.min.y + 1;
    out.depth = 1;
    out.full_x = display.min.x;
    out.full_y = display.min.y;
    out.full_width = display.max.x - display.min.x + 1;
    out.full_height = display.max.y - display.min.y + 1;
    out.format = "openexr";
    out.colour_space = "Linear";
    out.floating_point = true;
    if (const auto* crop = header.findTypedAttribute<Imf::StringAttribute>(crop_attribute))
        out.crop = crop->value();
    if (const auto* stops = header.findTypedAttribute<Imf::StringAttribute>(exposure_attribute))
        out.exposure = stops->value();
    if (const auto* stops = header.findTypedAttribute<Imf::DoubleAttribute>(exposure_attribute))
        out.exposure = fmt::format("{}", stops->value());
    if (const auto* text = header.findTypedAttribute<Imf::StringAttribute>(made_by_attribute))
        out.made_by = text->value();
    return out;
}

std::unique_ptr<PictureReader> open_plain_exr(const std::filesystem::path& path) {
    const int threads = exr_library_threads();
    try {
        auto file = std::make_unique<Imf::MultiPartInputFile>(path.c_str(), threads);
        if (!file->partComplete(0)) return nullptr;
        if (auto layout = plain_layout(file->header(0)))
            return std::make_unique<ExrReader>(std::move(file), std::move(*layout));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        // The OpenEXR library cannot read this file. The result is null, so the caller tries to open the file
        // with OpenImageIO, which then reports the error.
    }
    return nullptr;
}

/// A PNG reader and the file that it reads.
class PngFileReader : public PictureReader {
  public:
    PngFileReader(Bytes bytes, std::unique_ptr<PictureReader> png)
        : bytes_(std::move(bytes)), png_(std::move(png)) {}
    [[nodiscard]] const PictureLayout& layout() const override { return png_->layout(); }
    [[nodiscard]] std::string read(int channels, float* to) override { return png_->read(channels, to); }

  private:
    Bytes bytes_;
    std::unique_ptr<PictureReader> png_;
};

}  // namespace

std::unique_ptr<PictureReader> open_plain_picture(const std::filesystem::path& path) {
    const InputFile file(path);
    std::array<std::uint8_t, 4> magic{};
    if (file.size() < magic.size()) return nullptr;
    file.read_at(0, magic);
    if (magic == std::array<std::uint8_t, 4>{0x76, 0x2F, 0x31, 0x01}) return open_plain_exr(path);
    constexpr std::uint64_t largest_png = 1U << 30U;
    if (magic != std::array<std::uint8_t, 4>{0x89, 'P', 'N', 'G'} || file.size() > largest_png)
        return nullptr;
    Bytes bytes(file.size());
    file.read_at(0, bytes);
    auto png = open_plain_png({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return png ? std::make_unique<PngFileReader>(std::move(bytes), std::move(png)) : nullptr;
}

}  // namespace postlens
