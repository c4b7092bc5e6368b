#include "records/file/sample_file_layout.h"

#include <cstring>

#include "core/checksum.h"

namespace postlens::layout {
namespace {

/// Summary of one row of records (surface hits), as the part `scanlines` of the sample file stores it. It has
/// one OpenEXR channel for each field, in this order. For example, the field `z_far` is the channel Z.far.
struct RowFields {
    float z_far, z_near;
    std::uint32_t checksum_hi, checksum_lo, picture_hi, picture_lo, records, row_check;

    [[nodiscard]] std::uint32_t expected_check(int y) const {
        struct {
            std::int32_t y;
            float z_far, z_near;
            std::uint32_t rest[5];
        } bytes{y, z_far, z_near, {checksum_hi, checksum_lo, picture_hi, picture_lo, records}};
        return static_cast<std::uint32_t>(checksum_of(&bytes, sizeof bytes));
    }
};
static_assert(sizeof(RowFields) == ScanlineRow::byte_count);

std::uint32_t high(std::uint64_t v) {
    return static_cast<std::uint32_t>(v >> 32U);
}
std::uint32_t low(std::uint64_t v) {
    return static_cast<std::uint32_t>(v);
}
std::uint64_t joined(std::uint32_t hi, std::uint32_t lo) {
    return (static_cast<std::uint64_t>(hi) << 32U) | lo;
}

}  // namespace

ChunkCompression codec_of(RecordCompression c) {
    switch (c) {
        case RecordCompression::none:
            return ChunkCompression::none;
        case RecordCompression::rle:
            return ChunkCompression::rle;
        case RecordCompression::zips:
            return ChunkCompression::zips;
    }
    return ChunkCompression::none;
}

std::string part_name(const PartPlace& place) {
    constexpr std::array<const char*, parts_of_first_instant> names{"picture", "records", "scanlines"};
    std::string name = names[static_cast<std::size_t>(place.part)];
    if (place.instant > 0) name += ".k" + std::to_string(place.instant);
    return name;
}

std::vector<ExrChannel> channels_of(Part part, RecordChannels channels) {
    using Type = ExrChannel::Type;
    if (part == picture_part) return {{"B", Type::float32}, {"G", Type::float32}, {"R", Type::float32}};
    if (part == scanlines_part) {
        return {{"Z.far", Type::float32},      {"Z.near", Type::float32},    {"checksum.hi", Type::uint32},
                {"checksum.lo", Type::uint32}, {"picture.hi", Type::uint32}, {"picture.lo", Type::uint32},
                {"records", Type::uint32},     {"row.check", Type::uint32}};
    }
    std::vector<ExrChannel> list{{"B", Type::float32}, {"G", Type::float32}, {"R", Type::float32}};
    if (channels.has_bend) list.push_back({"W.bend", Type::half});
    if (channels.has_w) {
        for (const char* name : {"W.xx", "W.xy", "W.yx", "W.yy"}) list.push_back({name, Type::float32});
    }
    list.push_back({"Z", Type::float32});
    list.push_back({"id", Type::uint32});
    if (channels.has_layers) list.push_back({"layer", Type::uint32});
    if (channels.has_marks) list.push_back({"mark", Type::half});
    list.push_back({"node.path", Type::uint32});
    list.push_back({"sample.x", Type::half});
    list.push_back({"sample.y", Type::half});
    return list;
}

Window display_window(const SampleHeader& header) {
    return {0, 0, header.width - 1, header.height - 1};
}

Window data_window(Part part, const SampleHeader& header) {
    const int o = header.overscan_px;
    if (part == picture_part) return display_window(header);
    // Records (surface hits) lie at the corners of pixels, and therefore also at the right and lower borders
    // of the image. So their data window has one more column and one more row than the image with its
    // overscan.
    if (part == records_part) return {-o, -o, header.width + o, header.height + o};
    return {0, -o, 0, header.height + o};
}

std::array<std::uint8_t, ScanlineRow::byte_count> ScanlineRow::bytes(int y) const {
    RowFields fields{facts.farthest_z,       facts.nearest_z,       high(facts.checksum), low(facts.checksum),
                     high(picture_checksum), low(picture_checksum), facts.records,        0};
    fields.row_check = fields.expected_check(y);
    std::array<std::uint8_t, byte_count> out{};
    std::memcpy(out.data(), &fields, sizeof fields);
    return out;
}

std::optional<ScanlineRow> ScanlineRow::from_bytes(ByteView bytes, int y) {
    RowFields fields{};
    if (bytes.size() != sizeof fields) return std::nullopt;
    std::memcpy(&fields, bytes.data(), sizeof fields);
    if (fields.row_check != fields.expected_check(y)) return std::nullopt;
    ScanlineRow row;
    row.facts = {fields.records, fields.z_near, fields.z_far, joined(fields.checksum_hi, fields.checksum_lo)};
    row.picture_checksum = joined(fields.picture_hi, fields.picture_lo);
    return row;
}

std::uint64_t picture_row_checksum(ByteView planes) {
    return checksum_of(planes.data(), planes.size());
}

}  // namespace postlens::layout
