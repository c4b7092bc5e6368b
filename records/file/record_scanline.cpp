#include "records/file/record_scanline.h"

#include <Imath/half.h>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/checksum.h"

namespace postlens {
namespace {

static_assert(std::endian::native == std::endian::little,
              "chunks are copied as they are; OpenEXR is little-endian");

/// Converts positions within a pixel between half floats, in which the file stores them, and floats. Valid
/// positions are multiples of 1/1024 px, which half floats represent exactly. All other half floats are
/// converted to NaN, so that damage to the file is found.
struct HalfOffsets {
    std::array<std::uint16_t, position_steps> half_of_step{};
    std::array<float, 65536> offset_of_half{};
    HalfOffsets() {
        offset_of_half.fill(std::numeric_limits<float>::quiet_NaN());
        for (int k = 0; k < position_steps; ++k) {
            const Imath::half h(static_cast<float>(k) / position_steps);
            half_of_step[static_cast<std::size_t>(k)] = h.bits();
            offset_of_half[h.bits()] = static_cast<float>(k) / position_steps;
        }
    }
};

const HalfOffsets& half_offsets() {
    static const HalfOffsets table;
    return table;
}

template <typename T>
T load(const std::uint8_t* from, std::size_t index) {
    T value;
    std::memcpy(&value, from + index * sizeof(T), sizeof(T));
    return value;
}

template <typename T>
void store(std::uint8_t* to, std::size_t index, T value) {
    std::memcpy(to + index * sizeof(T), &value, sizeof(T));
}

/// Pointers to the first value of each channel.
template <typename Byte>
struct Planes {
    Planes(Byte* data, std::size_t n, RecordChannels channels) {
        const auto take = [&](std::size_t bytes) {
            Byte* at = data;
            data += n * bytes;
            return at;
        };
        b = take(4);
        g = take(4);
        r = take(4);
        if (channels.has_bend) bend = take(2);
        if (channels.has_w) {
            for (Byte*& plane : w) plane = take(4);
        }
        z = take(4);
        id = take(4);
        if (channels.has_layers) layer = take(4);
        if (channels.has_marks) mark = take(2);
        path = take(4);
        x = take(2);
        y = take(2);
    }
    Byte *b, *g, *r, *z, *id, *path, *x, *y;
    Byte *layer = nullptr, *bend = nullptr, *mark = nullptr;
    std::array<Byte*, 4> w{};
};

float float_of_half(std::uint16_t bits) {
    Imath::half h(0);
    h.setBits(bits);
    return h;
}

/// Converts the mark of a record (a set of flags, RecordMark) from a half float, in which the file stores it,
/// to an integer. An invalid half float becomes 255, which contains unknown flags. So the damage is found
/// when the records are checked.
std::uint8_t mark_of_half(std::uint16_t bits) {
    const float value = float_of_half(bits);
    return value >= 0 && value <= 255 && value == std::floor(value) ? static_cast<std::uint8_t>(value) : 255;
}

std::uint16_t half_of_offset(const HalfOffsets& table, float position, float pixel) {
    return table.half_of_step[static_cast<std::size_t>((position - pixel) * position_steps)];
}

}  // namespace

std::size_t bytes_per_record(RecordChannels channels) {
    return 28 + (channels.has_w ? 16U : 0U) + (channels.has_bend ? 2U : 0U) +
           (channels.has_layers ? 4U : 0U) + (channels.has_marks ? 2U : 0U);
}

void ScanlineBytes::prepare(int y, std::uint32_t records) {
    y_ = y;
    records_ = records;
    bytes_.resize(y_bytes + count_bytes() + records * bytes_per_record(channels_));
    store(bytes_.data(), 0, static_cast<std::int32_t>(y));
}

void ScanlineBytes::pack(int y, int x_begin, std::span<const std::uint32_t> offsets,
                         std::span<const Record> records) {
    assert(offsets.size() == static_cast<std::size_t>(width_) + 1);
    const std::uint32_t first = offsets.front();
    prepare(y, offsets.back() - first);
    const HalfOffsets& table = half_offsets();
    const auto pixel_y = static_cast<float>(y);
    std::uint8_t* sums = counts().data();
    const Planes<std::uint8_t> planes(channel_data().data(), records_, channels_);
    const Record* record = records.data() + first;
    std::size_t k = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
        const std::uint32_t end = offsets[i + 1] - first;
        const auto pixel_x = static_cast<float>(x_begin + static_cast<int>(i));
        store(sums, i, end);
        for (; k < end; ++k, ++record) {
            store(planes.b, k, record->b);
            store(planes.g, k, record->g);
            store(planes.r, k, record->r);
            store(planes.z, k, record->z);
            store(planes.id, k, record->id);
            store(planes.path, k, record->path.bits());
            store(planes.x, k, half_of_offset(table, record->x, pixel_x));
            store(planes.y, k, half_of_offset(table, record->y, pixel_y));
            if (channels_.has_layers) store(planes.layer, k, record->layer);
            if (channels_.has_bend) store(planes.bend, k, Imath::half(record->w_bend).bits());
            if (channels_.has_marks) store(planes.mark, k, Imath::half(record->mark).bits());
            if (channels_.has_w) {
                store(planes.w[0], k, record->w.xx);
                store(planes.w[1], k, record->w.xy);
                store(planes.w[2], k, record->w.yx);
                store(planes.w[3], k, record->w.yy);
            }
        }
    }
}

bool ScanlineBytes::unpack_offsets(std::span<std::uint32_t> offsets) const {
    assert(offsets.size() == static_cast<std::size_t>(width_) + 1);
    const std::uint8_t* table = bytes_.data() + y_bytes;
    offsets[0] = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
        offsets[i + 1] = load<std::uint32_t>(table, i);
        if (offsets[i + 1] < offsets[i]) return false;
    }
    return offsets.back() == records_;
}

bool ScanlineBytes::unpack_records(int x_begin, std::span<const std::uint32_t> offsets,
                                   std::span<Record> records) const {
    assert(records.size() == records_);
    const Planes<const std::uint8_t> planes(bytes_.data() + y_bytes + count_bytes(), records_, channels_);
    const auto& offset_of_half = half_offsets().offset_of_half;
    const auto pixel_y = static_cast<float>(y_);
    float sum = 0;  // becomes NaN if one offset is NaN
    std::size_t k = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
        const auto pixel_x = static_cast<float>(x_begin + static_cast<int>(i));
        for (; k < offsets[i + 1]; ++k) {
            Record& r = records[k];
            r.b = load<float>(planes.b, k);
            r.g = load<float>(planes.g, k);
            r.r = load<float>(planes.r, k);
            r.z = load<float>(planes.z, k);
            r.id = load<std::uint32_t>(planes.id, k);
            r.path = NodePath(load<std::uint32_t>(planes.path, k));
            const float offset_x = offset_of_half[load<std::uint16_t>(planes.x, k)];
            const float offset_y = offset_of_half[load<std::uint16_t>(planes.y, k)];
            sum += offset_x + offset_y;
            r.x = pixel_x + offset_x;
            r.y = pixel_y + offset_y;
            r.layer = channels_.has_layers ? load<std::uint32_t>(planes.layer, k) : 0;
            r.w = channels_.has_w ? Mat2{load<float>(planes.w[0], k), load<float>(planes.w[1], k),
                                         load<float>(planes.w[2], k), load<float>(planes.w[3], k)}
                                  : Mat2::isotropic(1.0F / r.z);
            r.mark =
                channels_.has_marks ? mark_of_half(load<std::uint16_t>(planes.mark, k)) : std::uint8_t{0};
            r.w_bend = channels_.has_bend ? float_of_half(load<std::uint16_t>(planes.bend, k)) : 0;
        }
    }
    return !std::isnan(sum);
}

std::uint64_t ScanlineBytes::checksum() const {
    return checksum_of(bytes_.data(), bytes_.size());
}

}  // namespace postlens
