#include "records/coarser_file.h"

#include "core/error.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Appends the row of pixels of `fine` that is row y of the wider pixels to `out`, whose columns are given.
void append_row(const RecordBand& fine, int y, int by, RecordBand& out) {
    for (int x = out.x_begin; x < out.x_end; ++x) {
        const std::size_t pixel = fine.pixel(x * by, y * by);
        for (std::size_t i = fine.offsets[pixel]; i < fine.offsets[pixel + 1]; ++i) {
            Record record = fine.records[i];
            if (record.x != static_cast<float>(x * by) || record.y != static_cast<float>(y * by)) continue;
            record.x = static_cast<float>(x);
            record.y = static_cast<float>(y);
            out.records.push_back(record);
        }
        out.offsets.push_back(static_cast<std::uint32_t>(out.records.size()));
    }
}

}  // namespace

std::uint64_t write_coarser_file(const std::filesystem::path& fine, Damage damage, int by,
                                 const std::filesystem::path& coarse) {
    constexpr double as_stored = 0;  // the exposure at which a colour is its radiance
    const SampleFileReader file(fine, damage, as_stored);
    SampleHeader header = file.header();
    if (by < 1 || header.width < by || header.height < by)
        fail(ExitCode::wrong_arguments, "{}: {} x {} px are too few for pixels of {} x {}", fine.string(),
             header.width, header.height, by, by);
    header.width /= by;
    header.height /= by;
    header.overscan_px /= by;
    header.pixel_pitch_mm *= by;
    header.subdivide_levels = 0;
    std::uint64_t records = 0;
    SampleFileWriter writer(coarse, header, RecordCompression::none);
    for (std::size_t instant = 0; instant < file.instants(); ++instant) {
        if (instant > 0) writer.next_instant();
        const auto count =
            static_cast<std::size_t>(header.height) + 2 * static_cast<std::size_t>(header.overscan_px) + 1;
        constexpr std::size_t at_a_time = 32;
        make_in_order(
            count, at_a_time,
            [&](std::size_t i) {
                const int y = static_cast<int>(i) - header.overscan_px;
                RecordBand read;
                file.read(y * by, y * by + 1, read, instant);
                RecordBand row{.x_begin = -header.overscan_px,
                               .x_end = header.width + header.overscan_px + 1,
                               .y_begin = y,
                               .y_end = y + 1};
                append_row(read, y, by, row);
                return row;
            },
            [&](std::size_t, const RecordBand& row) {
                records += row.records.size();
                writer.write(row);
            });
    }
    writer.finish();
    return records;
}

}  // namespace postlens
