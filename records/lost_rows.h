// Rows of records that cannot be read from a damaged sample file, and the records that replace them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "records/record.h"

namespace postlens {

/// Rows [y_begin, y_end) of the records of one instant.
struct LostRows {
    std::size_t instant = 0;
    int y_begin = 0, y_end = 0;
    friend bool operator==(const LostRows&, const LostRows&) = default;
};

/// Replacement for row y, columns [x_begin, x_end), of a damaged file. It has a point sample of a ray that
/// hit nothing at the upper-left corner of every pixel. It has further such samples where quadtree leaves of
/// the row above need them as lower corners. `above` holds the row above; nullptr if that row is lost or does
/// not exist. Offsets are as in RecordBand.
void stand_in_for_row(const RecordBand* above, int x_begin, int x_end, int y,
                      std::vector<std::uint32_t>& offsets, std::vector<Record>& records);

/// The same as a band of one row.
[[nodiscard]] RecordBand stand_in_row(const RecordBand* above, int x_begin, int x_end, int y);

/// Rows [y_begin, y_end) of a band that has them.
[[nodiscard]] RecordBand rows_of(const RecordBand& band, int y_begin, int y_end);

/// Merges neighbouring lost rows of an instant. `lost` has one flag per row, from row y_begin on.
void add_runs(std::size_t instant, std::span<const std::uint8_t> lost, int y_begin,
              std::vector<LostRows>& runs);

/// "rows 12-19, 40-47", the first and the last of each run; long lists are cut short.
[[nodiscard]] std::string rows_text(std::span<const LostRows> runs);

}  // namespace postlens
