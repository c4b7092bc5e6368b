#include "records/foreign_file.h"

#include <ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <new>

#include "core/error.h"
#include "core/memory.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr int longest_edge = 1 << 16;  ///< px; half a pixel is exact in float far beyond
constexpr std::uint64_t most_pixels = 1U << 29U;
constexpr std::size_t most_parts = 256;
constexpr std::size_t most_channels = 1024;
constexpr std::uint64_t most_chunk_bytes = 256U << 20U;
/// What may be asked for without a look at the file's own size.
constexpr std::uint64_t unquestioned_bytes = 64U << 20U;
/// Pixels of a display window that any file may have: 16384 by 16384.
constexpr std::uint64_t unquestioned_shown = std::uint64_t{1} << 28U;
/// The densest of the formats, deflate, packs 1032 to 1; twice over in none of them.
constexpr std::uint64_t densest = 4096;

std::string one_line(std::string text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.empty() ? "no reason given" : text;
}

/// Runs what calls the OpenEXR library, whose exceptions become ours.
template <typename Call>
auto guarded(const std::string& name, const Call& call) {
    try {
        return call();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail(ExitCode::out_of_memory, "{}: not enough memory to read it", name);
    } catch (const std::exception& e) {
        fail(ExitCode::invalid_input, "{}: cannot read ({})", name, one_line(e.what()));
    }
}

Window checked_window(const ExrPart& part, const char* attribute, const std::string& name) {
    const auto w = part.get_window(attribute);
    if (!w) fail(ExitCode::invalid_input, "{}: header is damaged (no {})", name, attribute);
    const std::int64_t width = std::int64_t{w->x_max} - w->x_min + 1,
                       height = std::int64_t{w->y_max} - w->y_min + 1;
    constexpr std::int64_t farthest = 1 << 20;
    if (width < 1 || height < 1 || width > longest_edge || height > longest_edge ||
        static_cast<std::uint64_t>(width * height) > most_pixels ||
        std::abs(std::int64_t{w->x_min}) > farthest || std::abs(std::int64_t{w->y_min}) > farthest) {
        fail(ExitCode::invalid_input,
             "{}: {} is out of bounds (got {}x{} px at {},{}; expected edges of 1 to {} px and at most 2^29 "
             "px)",
             name, attribute, width, height, w->x_min, w->y_min, longest_edge);
    }
    return *w;
}

}  // namespace

// What the library is about to believe, looked at before.
struct ForeignFile::Impl {
    struct Opened {
        std::string name;
        std::uint64_t bytes = 0;
        std::size_t first_part = 0;
        std::unique_ptr<Imf::MultiPartInputFile> file;
    };
    std::vector<Opened> files;  ///< the picture's, and those attached

    [[nodiscard]] const Opened& of(std::size_t part) const {
        std::size_t i = files.size() - 1;
        while (files[i].first_part > part) --i;
        return files[i];
    }
    /// The part's number in its own file.
    [[nodiscard]] int number(std::size_t part) const { return static_cast<int>(part - of(part).first_part); }
    [[nodiscard]] const Imf::Header& header(std::size_t part) const {
        return of(part).file->header(number(part));
    }
    template <typename Attribute>
    [[nodiscard]] const Attribute* find(std::size_t part, const char* name) const {
        return header(part).findTypedAttribute<Attribute>(name);
    }
};

namespace {

/// Bytes of one pixel of a flat part, or of one sample of a deep one.
std::uint64_t bytes_of_pixel(const Imf::Header& h) {
    std::uint64_t bytes = 0;
    for (auto c = h.channels().begin(); c != h.channels().end(); ++c)
        bytes += c.channel().type == Imf::HALF ? 2 : 4;
    return bytes;
}

int chunk_rows(const Imf::Header& h) {
    switch (h.compression()) {
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::PIZ_COMPRESSION:
        case Imf::B44_COMPRESSION:
        case Imf::B44A_COMPRESSION:
        case Imf::DWAA_COMPRESSION:
            return 32;
        case Imf::DWAB_COMPRESSION:
            return 256;
        default:
            return 1;
    }
}

void check_chunks(const ForeignPart& part, const Imf::Header& h, std::uint64_t file_bytes,
                  const std::string& name) {
    const auto width = static_cast<std::uint64_t>(part.width());
    std::uint64_t chunk_pixels = width * static_cast<std::uint64_t>(std::min(chunk_rows(h), part.height()));
    if (part.tiled) {
        const Imf::TileDescription& tiles = h.tileDescription();
        constexpr unsigned largest_tile = 1U << 14U;
        if (tiles.xSize < 1 || tiles.ySize < 1 || tiles.xSize > largest_tile || tiles.ySize > largest_tile) {
            fail(ExitCode::invalid_input, "{}: header is damaged (got tiles of {}x{} px; expected 1 to {})",
                 name, tiles.xSize, tiles.ySize, largest_tile);
        }
        chunk_pixels = std::uint64_t{tiles.xSize} * tiles.ySize;
    }
    // A small crop of a large frame is a whole file; a picture of the frame asks for its memory when it is
    // made. Only frames that nobody has are held against the size of the file.
    const std::uint64_t shown = (static_cast<std::uint64_t>(part.display.x_max - part.display.x_min) + 1) *
                                (static_cast<std::uint64_t>(part.display.y_max - part.display.y_min) + 1);
    const std::int64_t shift_x = std::int64_t{part.data.x_min} - part.display.x_min,
                       shift_y = std::int64_t{part.data.y_min} - part.display.y_min;
    if (std::abs(shift_x) > longest_edge || std::abs(shift_y) > longest_edge ||
        (shown > unquestioned_shown && shown / densest > file_bytes)) {
        fail(ExitCode::invalid_input,
             "{}: displayWindow is out of bounds (got {}x{} px at {},{} with data at {},{} in a file of {} "
             "bytes)",
             name, part.display.x_max - part.display.x_min + 1, part.display.y_max - part.display.y_min + 1,
             part.display.x_min, part.display.y_min, part.data.x_min, part.data.y_min, file_bytes);
    }
    const std::uint64_t pixel_bytes = part.deep ? 4 : bytes_of_pixel(h);
    const std::uint64_t whole = width * static_cast<std::uint64_t>(part.height()) * pixel_bytes;
    if (chunk_pixels * pixel_bytes > most_chunk_bytes ||
        (whole > unquestioned_bytes && whole / densest > file_bytes)) {
        fail(ExitCode::invalid_input,
             "{}: header is damaged (got {}x{} pixels of {} bytes in a file of {} bytes)", name, part.width(),
             part.height(), pixel_bytes, file_bytes);
    }
}

}  // namespace

bool ForeignPart::has(const std::string& channel) const {
    return std::find(channels.begin(), channels.end(), channel) != channels.end();
}

ForeignFile::ForeignFile(const fs::path& path) : name_(path.string()), impl_(std::make_unique<Impl>()) {
    open(path, PartUse::picture);
}

void ForeignFile::attach(const fs::path& path, PartUse use) {
    open(path, use);
    const auto size = [](const Window& w) { return std::pair(w.x_max - w.x_min + 1, w.y_max - w.y_min + 1); };
    const auto [width, height] = size(parts_[0].display);
    const auto [other_width, other_height] = size(parts_.back().display);
    if (width != other_width || height != other_height) {
        fail(ExitCode::invalid_input, "{}: displayWindow differs from {} (got {}x{} px; expected {}x{})",
             path.string(), name_, other_width, other_height, width, height);
    }
}

void ForeignFile::open(const fs::path& path, PartUse use) {
    const std::string name = path.string();
    const std::size_t first = parts_.size();
    Impl::Opened& opened = impl_->files.emplace_back();
    opened.name = name;
    opened.first_part = first;
    {
        // Our own look at the headers first: it takes no more memory than the headers have bytes.
        const InputFile file(path);
        if (!is_openexr(path)) fail(ExitCode::invalid_input, "{}: cannot read (not an OpenEXR file)", name);
        opened.bytes = file.size();
        const ExrHeaders headers = read_exr_headers(file, most_parts + 1, AttributeSizes::filled);
        if (headers.parts.size() > most_parts) {
            fail(ExitCode::invalid_input, "{}: too many parts (expected at most {})", name, most_parts);
        }
        for (const ExrPart& p : headers.parts) {
            ForeignPart& part = parts_.emplace_back();
            part.use = use;
            part.data = checked_window(p, "dataWindow", name);
            part.display = checked_window(p, "displayWindow", name);
        }
    }
    guarded(name, [&] {
        opened.file = std::make_unique<Imf::MultiPartInputFile>(name.c_str(), 0, false);
        if (static_cast<std::size_t>(opened.file->parts()) != parts_.size() - first)
            fail(ExitCode::invalid_input, "{}: header is damaged (parts that are not counted)", name);
        for (std::size_t i = first; i < parts_.size(); ++i) {
            const Imf::Header& h = impl_->header(i);
            ForeignPart& part = parts_[i];
            part.name = text(i, "name").value_or("");
            part.view = text(i, "view").value_or("");
            if (const auto* views = impl_->find<Imf::StringVectorAttribute>(i, "multiView"))
                part.views = views->value();
            const std::string type = h.hasType() ? h.type() : Imf::SCANLINEIMAGE;
            part.deep = type == Imf::DEEPSCANLINE || type == Imf::DEEPTILE;
            part.tiled = h.hasTileDescription();
            for (auto c = h.channels().begin(); c != h.channels().end(); ++c) {
                if (part.channels.size() == most_channels) {
                    fail(ExitCode::invalid_input, "{}: too many channels (expected at most {})", name,
                         most_channels);
                }
                part.channels.emplace_back(c.name());
            }
            check_chunks(part, h, opened.bytes, name);
        }
    });
}

const std::string& ForeignFile::name_of(std::size_t part) const {
    return impl_->of(part).name;
}

bool ForeignFile::has_own_file(PartUse use) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const ForeignPart& p) { return p.use == use; });
}

ForeignFile::ForeignFile(ForeignFile&&) noexcept = default;
ForeignFile::~ForeignFile() = default;

std::optional<double> ForeignFile::number(std::size_t part, const char* name) const {
    const auto* a = impl_->find<Imf::FloatAttribute>(part, name);
    return a != nullptr ? std::optional<double>(static_cast<double>(a->value())) : std::nullopt;
}

std::optional<std::array<double, 2>> ForeignFile::pair(std::size_t part, const char* name) const {
    const auto* a = impl_->find<Imf::V2fAttribute>(part, name);
    if (a == nullptr) return std::nullopt;
    return std::array<double, 2>{static_cast<double>(a->value().x), static_cast<double>(a->value().y)};
}

std::optional<Matrix44> ForeignFile::matrix(std::size_t part, const char* name) const {
    const auto* a = impl_->find<Imf::M44fAttribute>(part, name);
    if (a == nullptr) return std::nullopt;
    Matrix44 m{};
    std::size_t i = 0;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) m[i++] = static_cast<double>(a->value()[row][column]);
    }
    return m;
}

std::optional<std::string> ForeignFile::text(std::size_t part, const char* name) const {
    const auto* a = impl_->find<Imf::StringAttribute>(part, name);
    return a != nullptr ? std::optional<std::string>(a->value()) : std::nullopt;
}

std::vector<std::pair<std::string, std::string>> ForeignFile::texts(std::size_t part,
                                                                    std::string_view prefix) const {
    std::vector<std::pair<std::string, std::string>> out;
    const Imf::Header& h = impl_->header(part);
    for (auto a = h.begin(); a != h.end(); ++a) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
        if (text != nullptr && std::string_view(a.name()).starts_with(prefix))
            out.emplace_back(a.name(), text->value());
    }
    return out;
}

ChannelKind ForeignFile::kind(std::size_t part, const std::string& channel) const {
    const Imf::Channel* c = impl_->header(part).channels().findChannel(channel.c_str());
    if (c == nullptr || c->type == Imf::HALF) return ChannelKind::half;
    return c->type == Imf::UINT ? ChannelKind::whole : ChannelKind::float32;
}

ChannelSampling ForeignFile::sampling(std::size_t part, const std::string& channel) const {
    const Imf::Channel* c = impl_->header(part).channels().findChannel(channel.c_str());
    return c == nullptr ? ChannelSampling() : ChannelSampling{c->xSampling, c->ySampling};
}

std::array<double, 3> ForeignFile::luminance_weights(std::size_t part) const {
    const Imf::Header& h = impl_->header(part);
    const Imath::V3f w =
        Imf::RgbaYca::computeYw(Imf::hasChromaticities(h) ? Imf::chromaticities(h) : Imf::Chromaticities());
    const std::array<double, 3> out{static_cast<double>(w.x), static_cast<double>(w.y),
                                    static_cast<double>(w.z)};
    // Green is what red and blue leave.
    if (!std::isfinite(out[0] + out[1] + out[2]) || std::abs(out[1]) < 1e-6) {
        fail(ExitCode::invalid_input, "{}: chromaticities are unusable (got luminance weights {}, {}, {})",
             name_of(part), out[0], out[1], out[2]);
    }
    return out;
}

bool ForeignFile::loses_bits(std::size_t part) const {
    const Imf::Compression c = impl_->header(part).compression();
    // PXR24 rounds them, but what was equal stays so.
    return c == Imf::DWAA_COMPRESSION || c == Imf::DWAB_COMPRESSION;
}

namespace {

/// What the library reads a channel as; whole numbers keep their bits, in the place of a float.
Imf::PixelType read_as(const Imf::Header& h, const std::string& channel, const std::string& name) {
    const Imf::Channel* c = h.channels().findChannel(channel.c_str());
    if (c == nullptr) fail(ExitCode::invalid_input, "{}: no channel {}", name, channel);
    if (c->xSampling != 1 || c->ySampling != 1) {
        fail(ExitCode::invalid_input,
             "{}: channel {} is subsampled (got {}x{}; expected a value for each pixel)", name, channel,
             c->xSampling, c->ySampling);
    }
    return c->type == Imf::UINT ? Imf::UINT : Imf::FLOAT;
}

}  // namespace

std::optional<std::size_t> ChannelList::add(const std::string& name) {
    if (name.empty()) return std::nullopt;
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto number = static_cast<std::size_t>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return number;
}

void ForeignFile::read_flat(std::size_t part, std::span<const std::string> channels,
                            const std::function<void(int, std::span<const float* const>)>& take) const {
    const ForeignPart& p = parts_[part];
    const std::string& name = name_of(part);
    guarded(name, [&] {
        const Imf::Header& h = impl_->header(part);
        const auto width = static_cast<std::size_t>(p.width());
        // Whole tiles and whole chunks at a time, so that none is unpacked twice.
        const int unit = p.tiled ? static_cast<int>(h.tileDescription().ySize) : chunk_rows(h);
        const int rows = std::min(p.height(), unit * std::max(1, 64 / unit));
        require_memory(width * static_cast<std::uint64_t>(rows) * channels.size() * sizeof(float),
                       "a band of the picture");
        std::vector<float> buffer(width * static_cast<std::size_t>(rows) * channels.size());
        std::vector<const float*> values(channels.size());
        Imf::InputPart in(*impl_->of(part).file, impl_->number(part));
        for (int y = p.data.y_min; y <= p.data.y_max; y += rows) {
            const int last = std::min(y + rows - 1, p.data.y_max);
            Imf::FrameBuffer frame;
            for (std::size_t c = 0; c < channels.size(); ++c) {
                // The library counts from the file's origin.
                const std::ptrdiff_t origin =
                    -(static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(width) + p.data.x_min);
                auto* base =
                    reinterpret_cast<char*>(buffer.data() + c * width * static_cast<std::size_t>(rows));
                frame.insert(channels[c],
                             Imf::Slice(read_as(h, channels[c], name),
                                        base + origin * static_cast<std::ptrdiff_t>(sizeof(float)),
                                        sizeof(float), sizeof(float) * width));
            }
            in.setFrameBuffer(frame);
            in.readPixels(y, last);
            for (int row = y; row <= last; ++row) {
                for (std::size_t c = 0; c < channels.size(); ++c) {
                    values[c] =
                        buffer.data() +
                        (c * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row - y)) * width;
                }
                take(row, values);
            }
        }
    });
}

std::vector<float> ForeignFile::read_sampled(std::size_t part, const std::string& channel) const {
    const ForeignPart& p = parts_[part];
    const ChannelSampling step = sampling(part, channel);
    const auto width = static_cast<std::size_t>(p.width()), height = static_cast<std::size_t>(p.height());
    // Values stand where both coordinates are multiples of the steps.
    const auto first = [](int from, int every) { return from + ((-from % every) + every) % every; };
    const int x0 = first(p.data.x_min, step.x), y0 = first(p.data.y_min, step.y);
    if (x0 > p.data.x_max || y0 > p.data.y_max) {
        fail(ExitCode::invalid_input, "{}: channel {} has no values (got one for every {}x{} px of {}x{} px)",
             name_of(part), channel, step.x, step.y, width, height);
    }
    const auto columns = static_cast<std::size_t>((p.data.x_max - x0) / step.x) + 1,
               rows = static_cast<std::size_t>((p.data.y_max - y0) / step.y) + 1;
    require_memory((columns * rows + width * height) * sizeof(float), "a channel with few values");
    std::vector<float> values(columns * rows);
    guarded(name_of(part), [&] {
        Imf::InputPart in(*impl_->of(part).file, impl_->number(part));
        Imf::FrameBuffer frame;
        // The library counts the values from the file's origin.
        const std::ptrdiff_t origin =
            -(static_cast<std::ptrdiff_t>(y0 / step.y) * static_cast<std::ptrdiff_t>(columns) + x0 / step.x);
        frame.insert(channel, Imf::Slice(Imf::FLOAT,
                                         reinterpret_cast<char*>(values.data()) +
                                             origin * static_cast<std::ptrdiff_t>(sizeof(float)),
                                         sizeof(float), sizeof(float) * columns, step.x, step.y));
        in.setFrameBuffer(frame);
        in.readPixels(p.data.y_min, p.data.y_max);
    });
    /// Between which values a pixel lies, and how far towards the second.
    struct Between {
        std::size_t first, second;
        float share;
    };
    const auto between = [](int at, int from, int every, std::size_t count) {
        const int offset = std::max(at - from, 0);
        const std::size_t i = std::min(static_cast<std::size_t>(offset / every), count - 1);
        return Between{i, std::min(i + 1, count - 1),
                       static_cast<float>(offset % every) / static_cast<float>(every)};
    };
    const auto mix = [](float a, float b, float share) { return a == b ? a : a + share * (b - a); };
    std::vector<float> out;
    out.reserve(width * height);
    for (int y = p.data.y_min; y <= p.data.y_max; ++y) {
        const Between v = between(y, y0, step.y, rows);
        for (int x = p.data.x_min; x <= p.data.x_max; ++x) {
            const Between u = between(x, x0, step.x, columns);
            const auto along = [&](std::size_t row) {
                return mix(values[row * columns + u.first], values[row * columns + u.second], u.share);
            };
            out.push_back(mix(along(v.first), along(v.second), v.share));
        }
    }
    return out;
}

namespace {

/// A band of deep pixels as the library wants it: counts, and a pointer for every pixel and channel.
class DeepBand {
  public:
    DeepBand(const ForeignPart& part, const Imf::Header& h, std::span<const std::string> channels,
             std::uint64_t file_bytes, const std::string& name)
        : part_(part), channels_(channels), file_bytes_(file_bytes), name_(name) {
        for (const std::string& c : channels) types_.push_back(read_as(h, c, name));
    }

    template <typename Input, typename Counts, typename Pixels>
    void read(Input& in, int y_begin, int y_end, const Counts& counts, const Pixels& pixels,
              const std::function<void(const DeepRows&)>& take) {
        const auto width = static_cast<std::size_t>(part_.width());
        const std::size_t count = width * static_cast<std::size_t>(y_end - y_begin);
        require_memory(count * (sizeof(std::uint32_t) + channels_.size() * sizeof(float*)),
                       "a band of pixels");
        counts_.assign(count, 0);
        pointers_.assign(channels_.size(), std::vector<float*>(count, nullptr));
        in.setFrameBuffer(frame(y_begin, width));
        counts(in);
        check_counts();
        place(count);
        pixels(in);
        DeepRows rows{.y_begin = y_begin, .y_end = y_end, .count = counts_, .values = {}};
        for (const auto& v : values_) rows.values.emplace_back(v);
        take(rows);
    }

  private:
    Imf::DeepFrameBuffer frame(int y_begin, std::size_t width) {
        const std::ptrdiff_t origin =
            -(static_cast<std::ptrdiff_t>(y_begin) * static_cast<std::ptrdiff_t>(width) + part_.data.x_min);
        Imf::DeepFrameBuffer out;
        out.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                              reinterpret_cast<char*>(counts_.data()) +
                                                  origin * static_cast<std::ptrdiff_t>(sizeof(std::uint32_t)),
                                              sizeof(std::uint32_t), sizeof(std::uint32_t) * width));
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            out.insert(channels_[c], Imf::DeepSlice(types_[c],
                                                    reinterpret_cast<char*>(pointers_[c].data()) +
                                                        origin * static_cast<std::ptrdiff_t>(sizeof(float*)),
                                                    sizeof(float*), sizeof(float*) * width, sizeof(float)));
        }
        return out;
    }
    void check_counts() {
        std::uint64_t total = 0;
        for (const std::uint32_t n : counts_) total += n;
        const std::uint64_t bytes = total * channels_.size() * sizeof(float);
        if (bytes > unquestioned_bytes && bytes / densest > file_bytes_) {
            fail(ExitCode::invalid_input, "{}: sample counts are damaged (got {} samples in {} bytes)", name_,
                 total, file_bytes_);
        }
        require_memory(bytes, "a band of samples");
        total_ = total;
    }
    void place(std::size_t count) {
        values_.assign(channels_.size(), std::vector<float>(total_));
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            float* at = values_[c].data();
            for (std::size_t i = 0; i < count; ++i) {
                pointers_[c][i] = at;
                at += counts_[i];
            }
        }
    }

    const ForeignPart& part_;
    std::span<const std::string> channels_;
    std::uint64_t file_bytes_;
    const std::string& name_;
    std::vector<Imf::PixelType> types_;
    std::vector<std::uint32_t> counts_;
    std::vector<std::vector<float*>> pointers_;
    std::vector<std::vector<float>> values_;
    std::uint64_t total_ = 0;
};

/// The library takes as much memory as a chunk of a deep part says it has bytes before it looks for them.
/// Asked of a file of its own: where pixels are read, the library forgets its place when it is asked for a
/// size.
class StoredChunks {
  public:
    StoredChunks(const std::string& name, std::uint64_t file_bytes, int number, bool tiled)
        : name_(name), file_bytes_(file_bytes), file_(name.c_str(), 0, false) {
        if (tiled) {
            tiles_.emplace(file_, number);
        } else {
            rows_.emplace(file_, number);
        }
    }
    void check_row(int y) {
        std::uint64_t bytes = 0;
        rows_->rawPixelData(y, nullptr, bytes);
        check(bytes);
    }
    void check_tile(int x, int y) {
        int level_x = 0, level_y = 0;
        std::uint64_t bytes = 0;
        tiles_->rawTileData(x, y, level_x, level_y, nullptr, bytes);
        check(bytes);
    }

  private:
    void check(std::uint64_t bytes) const {
        if (bytes > file_bytes_) {
            fail(ExitCode::invalid_input, "{}: a chunk is damaged (got {} bytes in a file of {})", name_,
                 bytes, file_bytes_);
        }
    }

    const std::string& name_;
    std::uint64_t file_bytes_;
    Imf::MultiPartInputFile file_;
    std::optional<Imf::DeepScanLineInputPart> rows_;
    std::optional<Imf::DeepTiledInputPart> tiles_;
};

}  // namespace

void ForeignFile::read_deep(std::size_t part, std::span<const std::string> channels,
                            const std::function<void(const DeepRows&)>& take) const {
    const ForeignPart& p = parts_[part];
    const std::string& name = name_of(part);
    guarded(name, [&] {
        const Imf::Header& h = impl_->header(part);
        const Impl::Opened& opened = impl_->of(part);
        const int number = impl_->number(part);
        DeepBand band(p, h, channels, opened.bytes, name);
        StoredChunks stored(name, opened.bytes, number, p.tiled);
        if (p.tiled) {
            Imf::DeepTiledInputPart in(*opened.file, number);
            const int rows = static_cast<int>(in.tileYSize()), last_column = in.numXTiles(0) - 1;
            for (int t = 0; t < in.numYTiles(0); ++t) {
                const int y = p.data.y_min + t * rows;
                for (int column = 0; column <= last_column; ++column) stored.check_tile(column, t);
                band.read(
                    in, y, std::min(y + rows, p.data.y_max + 1),
                    [&](auto& from) { from.readPixelSampleCounts(0, last_column, t, t); },
                    [&](auto& from) { from.readTiles(0, last_column, t, t); }, take);
            }
            return;
        }
        Imf::DeepScanLineInputPart in(*opened.file, number);
        constexpr int rows = 16;
        for (int y = p.data.y_min; y <= p.data.y_max; y += rows) {
            const int last = std::min(y + rows - 1, p.data.y_max);
            for (int row = y; row <= last; row += chunk_rows(h)) stored.check_row(row);
            band.read(
                in, y, last + 1, [&](auto& from) { from.readPixelSampleCounts(y, last); },
                [&](auto& from) { from.readPixels(y, last); }, take);
        }
    });
}

bool is_openexr(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    std::ifstream in(path, std::ios::binary);
    char magic[4]{};
    return in.read(magic, 4) && magic[0] == 0x76 && magic[1] == 0x2f && magic[2] == 0x31 && magic[3] == 0x01;
}

}  // namespace postlens
