#include "pictures/foreign/foreign_planes.h"

#include <algorithm>

#include "core/memory.h"

namespace postlens {
namespace {

/// Extends an image beyond its display window (the visible rectangle). `plane` holds a channel of the file
/// part `from` on the pixel grid of another part, `onto`. Pixels outside this window that `from` does not
/// store get the value of the nearest pixel that it stores, but only on the sides where `from` reaches the
/// window's border.
void continue_beyond_border(const ForeignPart& from, const ForeignPart& onto, std::vector<float>& plane) {
    const int right = onto.display.x_min - from.display.x_min, down = onto.display.y_min - from.display.y_min;
    const int left_x = from.data.x_min + right, last_x = from.data.x_max + right,
              top_y = from.data.y_min + down, last_y = from.data.y_max + down;
    // The rectangle from (x_begin, y_begin) to (x_last, y_last), inclusive, contains the pixels that keep
    // their values. On a side that is not extended, it reaches the border of the data window of `onto`.
    const int x_begin = left_x > onto.display.x_min ? onto.data.x_min : std::max(left_x, onto.data.x_min),
              x_last = last_x < onto.display.x_max ? onto.data.x_max : std::min(last_x, onto.data.x_max),
              y_begin = top_y > onto.display.y_min ? onto.data.y_min : std::max(top_y, onto.data.y_min),
              y_last = last_y < onto.display.y_max ? onto.data.y_max : std::min(last_y, onto.data.y_max);
    if (x_begin > x_last || y_begin > y_last) return;
    const auto at = [&](int x, int y) -> float& {
        return plane[static_cast<std::size_t>(y - onto.data.y_min) * static_cast<std::size_t>(onto.width()) +
                     static_cast<std::size_t>(x - onto.data.x_min)];
    };
    for (int y = onto.data.y_min; y <= onto.data.y_max; ++y) {
        const int v = std::clamp(y, y_begin, y_last);
        for (int x = onto.data.x_min; x <= onto.data.x_max; ++x)
            at(x, y) = at(std::clamp(x, x_begin, x_last), v);
    }
}

}  // namespace

void each_row_onto(const ForeignFile& file, std::size_t part, std::span<const std::string> channels,
                   const ForeignPart& onto, const TakeRow& take) {
    const ForeignPart& from = file.parts()[part];
    // Two parts of the file may have different display windows. Pixel (x, y) of `from` is pixel (x + right, y
    // + down) of `onto`.
    const int right = onto.display.x_min - from.display.x_min, down = onto.display.y_min - from.display.y_min;
    const int x_begin = std::max(from.data.x_min + right, onto.data.x_min),
              x_last = std::min(from.data.x_max + right, onto.data.x_max);
    if (x_begin > x_last) return;
    const int columns = x_last - x_begin + 1, skipped = x_begin - right - from.data.x_min;
    const auto count = static_cast<std::size_t>(columns), first = static_cast<std::size_t>(skipped);
    file.read_flat(part, channels, [&](int own_y, std::span<const float* const> values) {
        const int y = own_y + down;
        if (y < onto.data.y_min || y > onto.data.y_max) return;
        take(static_cast<std::size_t>(y - onto.data.y_min) * static_cast<std::size_t>(onto.width()) +
                 static_cast<std::size_t>(x_begin - onto.data.x_min),
             count, first, values);
    });
}

std::vector<float> plane_onto(const ForeignFile& file, std::size_t part, const std::string& channel,
                              const ForeignPart& onto, float otherwise, bool converts) {
    const std::size_t pixels =
        static_cast<std::size_t>(onto.width()) * static_cast<std::size_t>(onto.height());
    require_memory(pixels * sizeof(float), "the channel of another part");
    std::vector<float> plane(pixels, otherwise);
    each_row_onto(
        file, part, std::span(&channel, 1), onto,
        [&](std::size_t first, std::size_t count, std::size_t from, std::span<const float* const> values) {
            const auto to = plane.begin() + static_cast<std::ptrdiff_t>(first);
            std::copy_n(values[0] + from, count, to);
            if (converts) std::transform(to, to + static_cast<std::ptrdiff_t>(count), to, number_of_bits);
        });
    continue_beyond_border(file.parts()[part], onto, plane);
    return plane;
}

std::optional<std::size_t> JoinedChannels::add(std::size_t part, const std::string& name, float otherwise,
                                               ChannelUse use) {
    if (name.empty()) return std::nullopt;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        if (channels_[i].part == part && channels_[i].name == name && channels_[i].use == use) return i;
    }
    Channel& channel = channels_.emplace_back();
    channel.part = part;
    channel.name = name;
    channel.use = use;
    const bool converts = use != ChannelUse::id && file_.kind(part, name) == ChannelKind::whole;
    if (use == ChannelUse::interpolated && part == part_ && file_.sampling(part, name) != ChannelSampling()) {
        channel.plane = file_.read_sampled(part, name);
    } else if (part != part_) {
        channel.plane = plane_onto(file_, part, name, file_.parts()[part_], otherwise, converts);
    } else {
        channel.row = *own_.add(name);
        channel.converted = converts;
    }
    return channels_.size() - 1;
}

void JoinedChannels::read(
    const std::function<void(int y, std::span<const float* const> values)>& take) const {
    const ForeignPart& part = file_.parts()[part_];
    const auto width = static_cast<std::size_t>(part.width());
    std::vector<const float*> joined(channels_.size());
    std::vector<std::vector<float>> numbers(channels_.size());
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        if (channels_[i].converted) numbers[i].resize(width);
    }
    file_.read_flat(part_, own_.names(), [&](int y, std::span<const float* const> values) {
        const std::size_t first = static_cast<std::size_t>(y - part.data.y_min) * width;
        for (std::size_t i = 0; i < channels_.size(); ++i) {
            const Channel& channel = channels_[i];
            joined[i] = channel.plane.empty() ? values[channel.row] : channel.plane.data() + first;
            if (!channel.converted) continue;
            std::transform(joined[i], joined[i] + width, numbers[i].begin(), number_of_bits);
            joined[i] = numbers[i].data();
        }
        take(y, joined);
    });
}

}  // namespace postlens
