#include "records/coarser_file.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/threads.h"

namespace postlens {
namespace {

bool is_at(const Record& record, int x, int y) {
    return record.x == static_cast<float>(x) && record.y == static_cast<float>(y);
}

/// Makes row y of a coarser file. Each of its pixels replaces `by` x `by` pixels of the original file, whose
/// records (surface hits) are in `fine`. The coarser pixel takes only the records at its upper left corner.
RecordBand wider_row(const RecordBand& fine, int y, int by, int x_begin, int x_end) {
    RecordBand out{.x_begin = x_begin, .x_end = x_end, .y_begin = y, .y_end = y + 1};
    for (int x = x_begin; x < x_end; ++x) {
        const std::size_t pixel = fine.pixel(x * by, y * by);
        for (std::size_t i = fine.offsets[pixel]; i < fine.offsets[pixel + 1]; ++i) {
            Record record = fine.records[i];
            if (!is_at(record, x * by, y * by)) continue;
            record.x = static_cast<float>(x);
            record.y = static_cast<float>(y);
            out.records.push_back(record);
        }
        out.offsets.push_back(static_cast<std::uint32_t>(out.records.size()));
    }
    return out;
}

}  // namespace

double corner_records(const SampleFileReader& file) {
    constexpr int most_counted = 32;
    const int rows = file.y_end() - file.y_begin(), step = (rows + most_counted - 1) / most_counted;
    double records = 0, counted = 0;
    RecordBand band;
    for (int y = file.y_begin() + step / 2; y < file.y_end(); y += step) {
        file.read(y, y + 1, band);
        records +=
            static_cast<double>(std::count_if(band.records.begin(), band.records.end(), [](const Record& r) {
                return is_at(r, static_cast<int>(std::floor(r.x)), static_cast<int>(std::floor(r.y)));
            }));
        ++counted;
    }
    return records * rows / counted;
}

void write_coarser_file(const SampleFileReader& file, int by, const std::filesystem::path& path) {
    SampleHeader header = file.header();
    if (by < 1 || header.width < by || header.height < by)
        fail(ExitCode::wrong_arguments, "{}: {} x {} px are too few for pixels of {} x {}", path.string(),
             header.width, header.height, by, by);
    header.width /= by;
    header.height /= by;
    header.overscan_px /= by;
    header.pixel_pitch_mm *= by;
    header.subdivide_levels = 0;
    header.key_times_s.clear();
    SampleFileWriter writer(path, header, RecordCompression::none);
    const int begin = -header.overscan_px, x_end = header.width + header.overscan_px + 1,
              y_end = header.height + header.overscan_px + 1;
    constexpr std::size_t at_a_time = 32;
    make_in_order(
        static_cast<std::size_t>(y_end - begin), at_a_time,
        [&](std::size_t i) {
            const int y = begin + static_cast<int>(i);
            RecordBand read;
            file.read(y * by, y * by + 1, read);
            return wider_row(read, y, by, begin, x_end);
        },
        [&](std::size_t, const RecordBand& row) { writer.write(row); });
    writer.finish();
}

}  // namespace postlens
