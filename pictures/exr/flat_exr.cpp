#include "pictures/exr/flat_exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <algorithm>
#include <cstring>

#include "pictures/exr/exr_output.h"

namespace postlens {
namespace {

using Type = ExrChannel::Type;

std::size_t bytes_of(Type type) {
    return type == Type::half ? 2 : 4;
}

Imf::Header header_of(const FlatExr& picture) {
    const auto box = [](const Window& w) {
        return Imath::Box2i(Imath::V2i(w.x_min, w.y_min), Imath::V2i(w.x_max, w.y_max));
    };
    Imf::Header out(box(picture.display), box(picture.data));
    // The cast is valid because the enumerations of the OpenEXR library and of this program use the numbers
    // of the file format.
    out.compression() = static_cast<Imf::Compression>(picture.compression);
    for (const auto& [name, text] : picture.texts) out.insert(name.c_str(), Imf::StringAttribute(text));
    for (const FlatExr::Channel& c : picture.channels)
        out.channels().insert(c.name, Imf::Channel(static_cast<Imf::PixelType>(c.type)));
    return out;
}

/// Copies the values of one channel in a row of pixels to consecutive positions. In the source, they are
/// `step` bytes apart.
template <std::size_t value_bytes>
void gather(const std::uint8_t* from, std::size_t step, std::size_t count, std::uint8_t* to) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * value_bytes, from + i * step, value_bytes);
}

}  // namespace

std::optional<std::uint64_t> write_flat_exr(const std::filesystem::path& path, const std::string& shown_name,
                                            const FlatExr& picture) {
    std::vector<FlatExr::Channel> channels = picture.channels;
    std::sort(channels.begin(), channels.end(),
              [](const auto& a, const auto& b) { return a.name < b.name; });  // the order within chunks
    std::size_t bytes_per_pixel = 0;
    for (const FlatExr::Channel& c : channels) bytes_per_pixel += bytes_of(c.type);
    const int columns = picture.data.x_max - picture.data.x_min + 1,
              height = picture.data.y_max - picture.data.y_min + 1,
              step = rows_per_chunk(picture.compression);
    const auto width = static_cast<std::size_t>(columns);
    const int chunks = (height + step - 1) / step;
    std::optional<std::size_t> chunk_bytes;
    if (picture.compression == ChunkCompression::none) chunk_bytes = width * bytes_per_pixel;
    ExrOutput file(path, shown_name, {header_of(picture)}, {static_cast<std::size_t>(chunks)}, chunk_bytes);
    ChunkCodec codec;
    Bytes raw, packed;
    for (int first = 0; first < height; first += step) {
        const int last = std::min(first + step, height);
        raw.resize(static_cast<std::size_t>(last - first) * width * bytes_per_pixel);
        std::uint8_t* to = raw.data();
        for (int y = first; y < last; ++y) {
            for (const FlatExr::Channel& c : channels) {
                const std::size_t value_bytes = bytes_of(c.type);
                using Layout = FlatExr::Channel::Layout;
                const std::size_t row_bytes = c.layout == Layout::pixels  ? picture.row_bytes
                                              : c.layout == Layout::plane ? width * value_bytes
                                                                          : 0;
                const auto* from =
                    static_cast<const std::uint8_t*>(c.first) + static_cast<std::size_t>(y) * row_bytes;
                const std::size_t apart = c.layout == Layout::pixels ? picture.pixel_bytes : value_bytes;
                (value_bytes == 2 ? gather<2> : gather<4>)(from, apart, width, to);
                to += width * value_bytes;
            }
        }
        file.write_flat_chunk(0, picture.data.y_min + first,
                              codec.compress(picture.compression, raw, packed));
    }
    file.finish();
    return file.checksum();
}

}  // namespace postlens
