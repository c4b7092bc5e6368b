// Part of ForeignFile: reads the pixels of flat parts.
#include <Imath/half.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfTileDescription.h>
#include <algorithm>
#include <cstring>
#include <future>

#include "core/job.h"
#include "core/memory.h"
#include "core/threads.h"
#include "pictures/exr/chunk_codec.h"
#include "pictures/foreign/foreign_file_impl.h"

namespace postlens {

using namespace foreign;

namespace {

using Take = std::function<void(int, std::span<const float* const>)>;

/// Returns the compression of a file part if ChunkCodec, our own decoder, can decode it. ChunkCodec takes a
/// third of the time that the OpenEXR library takes. Returns empty otherwise, for example if the part is
/// tiled or a channel is subsampled.
std::optional<ChunkCompression> own_compression(const ForeignPart& part, const Imf::Header& h) {
    if (part.tiled || h.compression() > Imf::ZIP_COMPRESSION) return std::nullopt;
    for (auto c = h.channels().begin(); c != h.channels().end(); ++c) {
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1) return std::nullopt;
    }
    // The cast is valid because Imf::Compression and ChunkCompression use the numbers of the file format.
    return static_cast<ChunkCompression>(h.compression());
}

/// Reads the compressed chunks of a part of an OpenEXR file. Each chunk holds whole rows of pixels. In a row,
/// the values of one channel are adjacent.
class ChunkReader {
  public:
    ChunkReader(const Imf::InputPart& in, ChunkCompression compression, const ForeignPart& part,
                std::span<const std::string> channels, const std::string& name)
        : in_(in), compression_(compression), part_(part), name_(name) {
        const Imf::ChannelList& all = in.header().channels();
        const auto width = static_cast<std::size_t>(part.width());
        channels_.resize(channels.size());
        for (auto c = all.begin(); c != all.end(); ++c) {
            const bool half = c.channel().type == Imf::HALF;
            for (std::size_t i = 0; i < channels.size(); ++i) {
                if (channels[i] == c.name()) channels_[i] = {row_bytes_, half};
            }
            row_bytes_ += width * (half ? 2 : 4);
        }
    }

    void read(const Take& take) const {
        constexpr int rows_of_band = 16;
        const auto width = static_cast<std::size_t>(part_.width());
        const std::size_t band_values = rows_of_band * width * channels_.size(),
                          at_a_time = static_cast<std::size_t>(thread_count()) + 1;
        require_memory(at_a_time * (band_values * sizeof(float) + 4 * rows_of_band * row_bytes_),
                       "the bands of the picture that are read at a time");
        // Each band has values, a packed chunk and an unpacked chunk.
        require_memory(at_a_time * (band_values * sizeof(float) + 2 * rows_of_band * row_bytes_),
                       "some bands of the picture");
        std::vector<Band> bands(at_a_time);
        std::vector<const float*> row(channels_.size());
        const auto first_row = [&](std::size_t i) {
            return part_.data.y_min + static_cast<int>(i) * rows_of_band;
        };
        const auto end_row = [&](std::size_t i) {
            return std::min(first_row(i) + rows_of_band, part_.data.y_max + 1);
        };
        run_in_order(
            static_cast<std::size_t>((part_.height() + rows_of_band - 1) / rows_of_band), at_a_time,
            [&](std::size_t i) {
                Band& band = bands[i % at_a_time];
                band.values.resize(band_values);
                float* to = band.values.data();
                const int step = rows_per_chunk(compression_);
                for (int y = first_row(i); y < end_row(i); y += step)
                    to = expand(y, std::min(y + step, end_row(i)), band, to);
            },
            [&](std::size_t i) {
                const float* values = bands[i % at_a_time].values.data();
                for (int y = first_row(i); y < end_row(i); ++y) {
                    for (const float*& channel : row) {
                        channel = values;
                        values += width;
                    }
                    take(y, row);
                }
            });
    }

  private:
    struct Channel {
        std::size_t offset = 0;  ///< of its first value in a row, in bytes
        bool half = false;       ///< otherwise 4 bytes per value
    };
    /// Buffers for reading a band of rows. Only one thread may use them at a time.
    struct Band {
        ChunkCodec codec;
        Bytes packed, raw;
        std::vector<float> values;  ///< row by row, and in each row channel by channel
    };

    /// Reads and decompresses the chunk that contains the image rows [y, y_end), and writes its values as
    /// floats to `to`. `band` provides the buffers that are needed for this. Returns the position after the
    /// last written value.
    float* expand(int y, int y_end, Band& band, float* to) const {
        // The OpenEXR library refuses chunks that are larger than uncompressed ones.
        band.packed.resize(static_cast<std::size_t>(rows_per_chunk(compression_)) * row_bytes_);
        auto bytes = static_cast<int>(band.packed.size());
        in_.rawPixelDataToBuffer(y, reinterpret_cast<char*>(band.packed.data()), bytes);
        band.raw.resize(static_cast<std::size_t>(y_end - y) * row_bytes_);
        if (!band.codec.decompress(compression_, ByteView(band.packed).first(static_cast<std::size_t>(bytes)),
                                   band.raw)) {
            fail(ExitCode::invalid_input, "{}: cannot read (the chunk of row {} is damaged)", name_, y);
        }
        const auto width = static_cast<std::size_t>(part_.width());
        for (const std::uint8_t* row = band.raw.data(); y < y_end; ++y, row += row_bytes_) {
            for (const Channel& channel : channels_) {
                const std::uint8_t* from = row + channel.offset;
                if (!channel.half) std::memcpy(to, from, width * sizeof(float));
                for (std::size_t x = 0; channel.half && x < width; ++x) {
                    std::uint16_t bits{};
                    std::memcpy(&bits, from + 2 * x, 2);
                    Imath::half value;
                    value.setBits(bits);
                    to[x] = value;
                }
                to += width;
            }
        }
        return to;
    }

    const Imf::InputPart& in_;
    ChunkCompression compression_;
    const ForeignPart& part_;
    const std::string& name_;
    std::vector<Channel> channels_;
    std::size_t row_bytes_ = 0;
};

}  // namespace

void ForeignFile::read_flat(std::size_t part, std::span<const std::string> channels, const Take& take) const {
    const ForeignPart& p = parts_[part];
    const std::string& name = name_of(part);
    guarded(name, [&] {
        const Imf::Header& h = impl_->header(part);
        const auto width = static_cast<std::size_t>(p.width());
        for (const std::string& channel : channels) static_cast<void>(read_as(h, channel, name));
        Imf::InputPart in(*impl_->of(part).file, impl_->number(part));
        if (const auto compression = own_compression(p, h)) {
            ChunkReader(in, *compression, p, channels, name).read(take);
            return;
        }
        // A band of rows consists of whole tiles or chunks, so that each is decompressed only once.
        const int unit = p.tiled ? static_cast<int>(h.tileDescription().ySize) : chunk_rows(h);
        const int rows = std::min(p.height(), unit * std::max(1, 64 / unit));
        const std::size_t plane = width * static_cast<std::size_t>(rows);
        require_memory(2 * plane * channels.size() * sizeof(float), "two bands of the picture");
        // Each channel of a band is one plane.
        const auto read_band = [&](int y, std::vector<float>& band) {
            Imf::FrameBuffer frame;
            for (std::size_t c = 0; c < channels.size(); ++c) {
                // The OpenEXR library expects the address of pixel (0, 0), even if this pixel is not stored.
                const std::ptrdiff_t origin =
                    -(static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(width) + p.data.x_min);
                auto* base = reinterpret_cast<char*>(band.data() + c * plane);
                frame.insert(channels[c],
                             Imf::Slice(read_as(h, channels[c], name),
                                        base + origin * static_cast<std::ptrdiff_t>(sizeof(float)),
                                        sizeof(float), sizeof(float) * width));
            }
            in.setFrameBuffer(frame);
            in.readPixels(y, std::min(y + rows - 1, p.data.y_max));
        };
        std::vector<float> band(plane * channels.size()), next_band(band.size());
        std::vector<const float*> values(channels.size());
        read_band(p.data.y_min, band);
        // The next band of rows is read from the file while the current one is processed.
        const auto policy = thread_count() > 1 ? std::launch::async : std::launch::deferred;
        for (int y = p.data.y_min; y <= p.data.y_max; y += rows) {
            std::future<void> next;
            if (y + rows <= p.data.y_max)
                next = std::async(policy, [&, from = y + rows] { read_band(from, next_band); });
            for (int row = y; row <= std::min(y + rows - 1, p.data.y_max); ++row) {
                throw_if_interrupted();
                for (std::size_t c = 0; c < channels.size(); ++c)
                    values[c] = band.data() + c * plane + static_cast<std::size_t>(row - y) * width;
                take(row, values);
            }
            if (next.valid()) next.get();
            std::swap(band, next_band);
        }
    });
}

std::vector<float> ForeignFile::read_sampled(std::size_t part, const std::string& channel) const {
    const ForeignPart& p = parts_[part];
    const ChannelSampling step = sampling(part, channel);
    const auto width = static_cast<std::size_t>(p.width()), height = static_cast<std::size_t>(p.height());
    // A subsampled channel stores values only at multiples of its sampling step, along x and along y. This
    // function returns the first x (or y) at which the channel stores a value: the smallest multiple of the
    // step `every` that is at least `from`, the border of the data window.
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
        // The OpenEXR library expects the address of pixel (0, 0), even if this pixel is not stored.
        const std::ptrdiff_t origin =
            -(static_cast<std::ptrdiff_t>(y0 / step.y) * static_cast<std::ptrdiff_t>(columns) + x0 / step.x);
        frame.insert(channel, Imf::Slice(Imf::FLOAT,
                                         reinterpret_cast<char*>(values.data()) +
                                             origin * static_cast<std::ptrdiff_t>(sizeof(float)),
                                         sizeof(float), sizeof(float) * columns, step.x, step.y));
        in.setFrameBuffer(frame);
        in.readPixels(p.data.y_min, p.data.y_max);
    });
    /// A subsampled channel stores values only for some pixels. The value of any other pixel is interpolated
    /// between two stored values along each axis. `first` and `second` are the indices of these values, and
    /// `share` is the weight of the second.
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

}  // namespace postlens
