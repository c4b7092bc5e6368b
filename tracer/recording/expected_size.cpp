#include "tracer/recording/expected_size.h"

#include <algorithm>

#include "core/job.h"
#include "records/packed_picture.h"

namespace postlens {
namespace {

constexpr int rows_of_stripe = 2;

int stripes(int rows) {
    constexpr int rows_per_stripe = 96, fewest = 4, most = 32;
    return std::min(std::clamp(rows / rows_per_stripe, fewest, most), (rows + 1) / rows_of_stripe);
}

}  // namespace

int looked_at_rows(int rows) {
    return std::min(rows, rows_of_stripe * stripes(rows));
}

std::uint64_t expected_file_bytes(const WhittedTracer& tracer, const SampledWindow& window,
                                  const SubdivisionSettings& subdivision, const SmallThings& things,
                                  const SampleHeader& header, RecordCompression compression,
                                  std::size_t instants) {
    const int rows = window.y_end - window.y_begin, count = stripes(rows);
    std::uint64_t bytes = 0, picture_bytes = 0;
    int looked_at = 0, picture_rows = 0;
    for (int i = 0; i < count; ++i) {
        throw_if_interrupted();
        // Measures the i-th of `count` stripes, i.e. bands of pixel rows, evenly spaced over the image. The
        // size of the whole file is estimated from the bytes that the records of these stripes would need.
        SampledWindow stripe = window;
        stripe.y_begin = window.y_begin + std::max(0, ((2 * i + 1) * rows / count - rows_of_stripe) / 2);
        stripe.y_end = std::min(stripe.y_begin + rows_of_stripe, window.y_end);
        // Counts the bytes of the stripe's rows. Records (surface hits) on the stripe's lower edge belong to
        // the pixel row below it. This row is not traced here, so the subdivision of its pixels is unknown,
        // and it has fewer records than it will have in the file. Therefore, it is not counted.
        sample_corners(
            tracer, stripe, subdivision,
            [&](const RecordBand& band) {
                const int end = std::min(band.y_end, stripe.y_end);
                bytes += packed_bytes(header, compression, band, band.y_begin, end);
                looked_at += end - band.y_begin;
                // The file contains an ordinary image besides the records. Pixel row y of this image is
                // computed from the records on the row's upper edge (row y of records) and on its lower edge
                // (row y + 1). `band` contains only some rows of records. For its last row, the next row of
                // records may be missing. So the image's row at this position is not counted.
                const int picture_end = std::min({end, band.y_end - 1, header.height});
                for (int y = std::max(0, band.y_begin); y < picture_end; ++y) {
                    picture_bytes += packed_picture_bytes(header, compression, band, y);
                    ++picture_rows;
                }
            },
            things);
    }
    const double per_instant = static_cast<double>(bytes) / looked_at * rows;
    const double picture = picture_rows == 0
                               ? 12.0 * header.width * header.height
                               : static_cast<double>(picture_bytes) / picture_rows * header.height;
    return static_cast<std::uint64_t>(per_instant * static_cast<double>(instants) + picture);
}

}  // namespace postlens
