// Part of ForeignFile: reads the pixels of flat parts.
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfTileDescription.h>
#include <algorithm>
#include <future>

#include "core/job.h"
#include "core/memory.h"
#include "pictures/foreign/foreign_file_impl.h"

namespace postlens {

using namespace foreign;

void ForeignFile::read_flat(std::size_t part, std::span<const std::string> channels,
                            const std::function<void(int, std::span<const float* const>)>& take) const {
    const ForeignPart& p = parts_[part];
    const std::string& name = name_of(part);
    guarded(name, [&] {
        const Imf::Header& h = impl_->header(part);
        const auto width = static_cast<std::size_t>(p.width());
        // A band consists of whole tiles or chunks, so that each of them is decompressed only once.
        const int unit = p.tiled ? static_cast<int>(h.tileDescription().ySize) : chunk_rows(h);
        const int rows = std::min(p.height(), unit * std::max(1, 64 / unit));
        const std::size_t plane = width * static_cast<std::size_t>(rows);
        require_memory(2 * plane * channels.size() * sizeof(float), "two bands of the picture");
        Imf::InputPart in(*impl_->of(part).file, impl_->number(part));
        // Each channel of a band is one plane.
        const auto read_band = [&](int y, std::vector<float>& band) {
            Imf::FrameBuffer frame;
            for (std::size_t c = 0; c < channels.size(); ++c) {
                // The OpenEXR library expects the address of pixel (0, 0) of the file, even if this pixel is
                // not stored.
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
        // The next band is read while the rows of this band are processed.
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
    // Returns the smallest multiple of the sampling step `every` that is not less than `from`. A subsampled
    // channel has values only at such x and y.
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
        // The OpenEXR library expects the address of the value at pixel (0, 0), even if this pixel is not
        // stored.
        const std::ptrdiff_t origin =
            -(static_cast<std::ptrdiff_t>(y0 / step.y) * static_cast<std::ptrdiff_t>(columns) + x0 / step.x);
        frame.insert(channel, Imf::Slice(Imf::FLOAT,
                                         reinterpret_cast<char*>(values.data()) +
                                             origin * static_cast<std::ptrdiff_t>(sizeof(float)),
                                         sizeof(float), sizeof(float) * columns, step.x, step.y));
        in.setFrameBuffer(frame);
        in.readPixels(p.data.y_min, p.data.y_max);
    });
    /// The indices of the two stored values on either side of a pixel, and the interpolation weight of the
    /// second.
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
