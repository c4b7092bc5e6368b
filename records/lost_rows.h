// Rows of records that damage has taken from a sample file, and what is read in their place.
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

/// What stands for row y, columns [x_begin, x_end): at the upper-left corner of every pixel a point sample of
/// a ray that met nothing. Where pixels of the row above are subdivided down to this one there are more, so
/// that every leaf up there has its corners. `above` holds that row; nullptr where it is lost or there is
/// none. Offsets are as in RecordBand.
void stand_in_for_row(const RecordBand* above, int x_begin, int x_end, int y,
                      std::vector<std::uint32_t>& offsets, std::vector<Record>& records);

/// Neighbouring rows of the same instant as one run: of `lost`, one flag a row from row y_begin on.
void add_runs(std::size_t instant, std::span<const std::uint8_t> lost, int y_begin,
              std::vector<LostRows>& runs);

/// "rows 12-19, 40-47", the first and the last of each run; long lists are cut short.
[[nodiscard]] std::string rows_text(std::span<const LostRows> runs);

}  // namespace postlens
