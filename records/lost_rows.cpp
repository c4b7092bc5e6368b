#include "records/lost_rows.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "records/record_check.h"

namespace postlens {
namespace {

/// Tests whether a pixel has a sample at a given position within it. Only samples of surfaces that the
/// pinhole sees (layer 0) count, not samples of hidden surfaces.
class PixelPlaces {
  public:
    PixelPlaces(std::span<const Record> records, int x, int y)
        : records_(records), x_(static_cast<float>(x)), y_(static_cast<float>(y)) {}

    /// True if the pixel has a sample u steps to the right of its upper left corner and v steps below that
    /// corner. A pixel is position_steps steps wide.
    [[nodiscard]] bool has(int u, int v) const {
        Record at;
        at.x = x_ + static_cast<float>(u) / position_steps;
        at.y = y_ + static_cast<float>(v) / position_steps;
        const auto found = std::lower_bound(records_.begin(), records_.end(), at, canonical_before);
        return found != records_.end() && found->layer == 0 && found->x == at.x && found->y == at.y;
    }

  private:
    std::span<const Record> records_;
    float x_, y_;
};

/// Finds the quadtree leaves (undivided cells) of a pixel that touch its lower edge, and appends the position
/// of each leaf's lower left corner to `corners`. It examines the cell that begins at u and is `size` wide,
/// in steps of 1 / position_steps px.
void add_lower_corners(const PixelPlaces& pixel, int u, int size, std::vector<int>& corners) {
    const int half = size / 2;
    // A cell is divided if there is a sample at its centre.
    if (half == 0 || !pixel.has(u + half, position_steps - half)) {
        corners.push_back(u);
        return;
    }
    add_lower_corners(pixel, u, half, corners);
    add_lower_corners(pixel, u + half, half, corners);
}

}  // namespace

void stand_in_for_row(const RecordBand* above, int x_begin, int x_end, int y,
                      std::vector<std::uint32_t>& offsets, std::vector<Record>& records) {
    offsets.assign(1, 0);
    records.clear();
    std::vector<int> corners;
    for (int x = x_begin; x < x_end; ++x) {
        corners.clear();
        if (above != nullptr) {
            const std::size_t k = above->pixel(x, y - 1);
            const auto pixel = std::span(above->records)
                                   .subspan(above->offsets[k], above->offsets[k + 1] - above->offsets[k]);
            add_lower_corners(PixelPlaces(pixel, x, y - 1), 0, position_steps, corners);
        } else {
            corners.push_back(0);
        }
        for (const int u : corners) {
            Record& nothing = records.emplace_back();
            nothing.x = static_cast<float>(x) + static_cast<float>(u) / position_steps;
            nothing.y = static_cast<float>(y);
            nothing.z = std::numeric_limits<float>::infinity();
        }
        offsets.push_back(static_cast<std::uint32_t>(records.size()));
    }
}

RecordBand stand_in_row(const RecordBand* above, int x_begin, int x_end, int y) {
    RecordBand out{.x_begin = x_begin, .x_end = x_end, .y_begin = y, .y_end = y + 1};
    stand_in_for_row(above, x_begin, x_end, y, out.offsets, out.records);
    return out;
}

RecordBand rows_of(const RecordBand& band, int y_begin, int y_end) {
    RecordBand out{.x_begin = band.x_begin, .x_end = band.x_end, .y_begin = y_begin, .y_end = y_end};
    if (y_end <= y_begin) return out;
    const std::size_t first = band.pixel(band.x_begin, y_begin), last = band.pixel(band.x_begin, y_end);
    const std::uint32_t from = band.offsets[first];
    out.offsets.assign(band.offsets.begin() + static_cast<std::ptrdiff_t>(first),
                       band.offsets.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    for (std::uint32_t& offset : out.offsets) offset -= from;
    out.records.assign(band.records.begin() + from, band.records.begin() + from + out.offsets.back());
    return out;
}

void add_runs(std::size_t instant, std::span<const std::uint8_t> lost, int y_begin,
              std::vector<LostRows>& runs) {
    for (std::size_t row = 0; row < lost.size(); ++row) {
        if (lost[row] == 0) continue;
        const int y = y_begin + static_cast<int>(row);
        if (row > 0 && lost[row - 1] != 0) {
            runs.back().y_end = y + 1;
        } else {
            runs.push_back({instant, y, y + 1});
        }
    }
}

std::string rows_text(std::span<const LostRows> runs) {
    constexpr std::size_t most_runs = 16;
    std::string text = runs.size() == 1 && runs[0].y_end == runs[0].y_begin + 1 ? "row " : "rows ";
    for (std::size_t i = 0; i < std::min(runs.size(), most_runs); ++i) {
        const int first = runs[i].y_begin, last = runs[i].y_end - 1;
        if (i > 0) text += ", ";
        text += first == last ? fmt::format("{}", first)
                : first < 0   ? fmt::format("{} to {}", first, last)
                              : fmt::format("{}-{}", first, last);
    }
    if (runs.size() > most_runs) text += fmt::format(" and {} more runs", runs.size() - most_runs);
    return text;
}

}  // namespace postlens
