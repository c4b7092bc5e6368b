#include "pictures/foreign/foreign_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfHeader.h>
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
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/job.h"
#include "pictures/exr/library_threads.h"
#include "pictures/foreign/foreign_file_impl.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using namespace foreign;

constexpr int longest_edge = 1 << 16;  ///< px; floats still represent half pixels exactly
constexpr std::uint64_t most_pixels = 1U << 29U;
constexpr std::size_t most_parts = 256;
constexpr std::size_t most_channels = 1024;
constexpr std::uint64_t most_chunk_bytes = 256U << 20U;
/// A display window (the rectangle of the whole image) of up to this many pixels, 16384 x 16384, is always
/// accepted. A larger display window is accepted only if the file is large enough for it, because the header
/// may be damaged.
constexpr std::uint64_t unquestioned_shown = std::uint64_t{1} << 28U;
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

namespace {

/// Returns the size, in bytes, of one pixel of a flat part, or of one sample of a deep part.
std::uint64_t bytes_of_pixel(const Imf::Header& h) {
    std::uint64_t bytes = 0;
    for (auto c = h.channels().begin(); c != h.channels().end(); ++c)
        bytes += c.channel().type == Imf::HALF ? 2 : 4;
    return bytes;
}

/// Returns the size of an uncompressed chunk (a tile, or rows that are compressed together), in bytes. To
/// detect damaged headers, throws Error(invalid_input) if the data window, the display window or the tiles of
/// the part are too large, or implausibly large for the size of the file.
std::uint64_t checked_chunk(const ForeignPart& part, const Imf::Header& h, std::uint64_t file_bytes,
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
    // Detects a damaged header by a display window (the rectangle of the whole image) that is too large for
    // the size of the file. Windows of up to `unquestioned_shown` pixels are accepted in any file, because a
    // small file may be a crop of a large image.
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
    return chunk_pixels * pixel_bytes;
}

/// Returns the number of threads with which the OpenEXR library reads a file, or 0 if the calling thread
/// reads it. `greatest_chunk` is the size of the largest chunk, in bytes. Few threads are used, because the
/// library allocates several chunks per thread and part.
int threads_of_file(std::uint64_t greatest_chunk) {
    // Largest number of threads. A file is read in bands of rows, one after another. With ZIP compression, a
    // band has only four chunks (blocks of rows that are compressed together). Only these four can be
    // decompressed at the same time, so more than two threads would hardly help.
    constexpr int most = 2;
    constexpr std::uint64_t most_bytes = 8U << 20U;
    return greatest_chunk > most_bytes || thread_count() < most ? 0 : std::min(exr_library_threads(), most);
}

}  // namespace

namespace foreign {

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

}  // namespace foreign

bool ForeignPart::has(const std::string& channel) const {
    return std::binary_search(channels.begin(), channels.end(), channel);
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
        // Checks the headers before the OpenEXR library reads them, so that a damaged file cannot cause large
        // allocations.
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
    std::uint64_t greatest_chunk = 0;
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
            const std::uint64_t chunk = checked_chunk(part, h, opened.bytes, name);
            // `greatest_chunk`, the size of the largest chunk in bytes, limits the number of threads. The
            // chunks of deep images have no fixed size, so the largest accepted size is assumed.
            greatest_chunk = std::max(greatest_chunk, part.deep ? most_chunk_bytes : chunk);
        }
    });
    if (const int threads = threads_of_file(greatest_chunk); threads > 0) {
        guarded(name, [&] {
            opened.file = std::make_unique<Imf::MultiPartInputFile>(name.c_str(), threads, false);
        });
    }
    const auto note_view = [&](const std::string& view) {
        if (!view.empty() && std::find(views_.begin(), views_.end(), view) == views_.end())
            views_.push_back(view);
    };
    for (std::size_t i = first; i < parts_.size(); ++i) {
        for (const std::string& view : parts_[i].views) note_view(view);
    }
    for (std::size_t i = first; i < parts_.size(); ++i) note_view(parts_[i].view);
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
    // `out` contains the luminance weights of red, green and blue. For a file with luminance and chroma,
    // green is computed by a division by its weight, out[1], so this weight must not be 0.
    if (!std::isfinite(out[0] + out[1] + out[2]) || std::abs(out[1]) < 1e-6) {
        fail(ExitCode::invalid_input, "{}: chromaticities are unusable (got luminance weights {}, {}, {})",
             name_of(part), out[0], out[1], out[2]);
    }
    return out;
}

bool ForeignFile::loses_bits(std::size_t part) const {
    const Imf::Compression c = impl_->header(part).compression();
    // PXR24 also rounds floats, but equal floats stay equal.
    return c == Imf::DWAA_COMPRESSION || c == Imf::DWAB_COMPRESSION;
}

std::optional<std::size_t> ChannelList::add(const std::string& name) {
    if (name.empty()) return std::nullopt;
    const auto found = std::find(names_.begin(), names_.end(), name);
    const auto number = static_cast<std::size_t>(found - names_.begin());
    if (found == names_.end()) names_.push_back(name);
    return number;
}

bool is_openexr(const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    std::ifstream in(path, std::ios::binary);
    char magic[4]{};
    return in.read(magic, 4) && magic[0] == 0x76 && magic[1] == 0x2f && magic[2] == 0x31 && magic[3] == 0x01;
}

}  // namespace postlens
