// Replaces unreadable rows of a damaged sample file by samples of rays that hit nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "records/record.h"

namespace postlens {

/// Consecutive lost (unreadable) rows, y_begin to y_end - 1, of one recorded instant.
struct LostRows {
    std::size_t instant = 0;
    int y_begin = 0, y_end = 0;
    friend bool operator==(const LostRows&, const LostRows&) = default;
};

/// Makes records that replace row y of a damaged file. They are records of rays that hit nothing, at the
/// upper left corner of each pixel, and at the lower corners of the quadtree cells of row y - 1.
/// - above: the row y - 1, or null if it is missing
/// - offsets: receives the index of each pixel's first record, as in RecordBand::offsets
void stand_in_for_row(const RecordBand* above, int x_begin, int x_end, int y,
                      std::vector<std::uint32_t>& offsets, std::vector<Record>& records);

/// Returns a RecordBand (rows of records) with a single row, which replaces row y of a damaged file. It
/// contains records of rays that hit nothing, as stand_in_for_row makes them. `above` is row y - 1, or null
/// if it is missing.
[[nodiscard]] RecordBand stand_in_row(const RecordBand* above, int x_begin, int x_end, int y);

/// Returns a copy of rows y_begin to y_end - 1 of a band, which must contain them.
[[nodiscard]] RecordBand rows_of(const RecordBand& band, int y_begin, int y_end);

/// Groups the lost (unreadable) rows of an instant into runs of consecutive rows, and appends them to `runs`.
/// `lost` has one flag per row, from row y_begin on.
void add_runs(std::size_t instant, std::span<const std::uint8_t> lost, int y_begin,
              std::vector<LostRows>& runs);

/// Lists lost (unreadable) rows of a file as text, for example "rows 12-19, 40-47". A long list is cut short.
[[nodiscard]] std::string rows_text(std::span<const LostRows> runs);

}  // namespace postlens
