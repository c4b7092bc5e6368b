// Rows of a damaged sample file whose records cannot be read, and the records that replace them.
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

/// Writes a replacement for the unreadable row y, columns [x_begin, x_end), of a damaged file. Every pixel
/// gets a sample at its upper-left corner, of a ray that hit nothing. Further samples of such rays are added
/// where quadtree leaves of the row above need them as lower corners. `above` contains the row above; nullptr
/// if that row is lost or does not exist. Offsets are as in RecordBand.
void stand_in_for_row(const RecordBand* above, int x_begin, int x_end, int y,
                      std::vector<std::uint32_t>& offsets, std::vector<Record>& records);

/// Makes the replacement of one unreadable row (stand_in_for_row) as a band.
[[nodiscard]] RecordBand stand_in_row(const RecordBand* above, int x_begin, int x_end, int y);

/// Copies rows [y_begin, y_end) of a band, which must contain them.
[[nodiscard]] RecordBand rows_of(const RecordBand& band, int y_begin, int y_end);

/// Appends the runs of neighbouring lost rows of an instant to `runs`. `lost` has one flag per row, from row
/// y_begin on.
void add_runs(std::size_t instant, std::span<const std::uint8_t> lost, int y_begin,
              std::vector<LostRows>& runs);

/// Formats runs of lost rows as "rows 12-19, 40-47": the first and last row of each. Long lists are
/// shortened.
[[nodiscard]] std::string rows_text(std::span<const LostRows> runs);

}  // namespace postlens
