// Finds the rows of the sample file that must be read again for each strip (group of rows) of a large image,
// because their samples are blurred into the strip.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "focus/responses/node_response.h"

namespace postlens {

/// Finds the rows of the sample file that must be read again for each strip. A strip is a group of rows of
/// the image; strips are computed one after another, to save memory.
///
/// An `Item`, for example a sample to be blurred, lies in a row of the file. Its blur may reach several rows
/// of the image, so it is needed for all strips that contain these rows. The few items that reach many rows
/// are kept in memory. Therefore, only the file rows near a strip must be read again.
template <typename Item>
class StripRows {
  public:
    struct Far {
        Item item;
        int first = 0, last = 0;  ///< pixel rows [first, last) that the item reaches
    };

    StripRows() = default;
    /// Creates an object to which no items (for example, samples) have been added yet.
    /// - `source`: window of the sample file, whose rows contain the items
    /// - `picture`: window of the image; its rows are divided into blocks of `block_px` rows, for which
    ///   `reaching` counts items
    StripRows(const RasterWindow& source, const RasterWindow& picture, int block_px)
        : y_begin_(source.y_begin),
          first_(picture.y_begin),
          block_px_(block_px),
          blocks_((picture.height() + block_px - 1) / block_px),
          rows_(static_cast<std::size_t>(source.height())) {}

    /// Prepares row y for adding its samples: removes the samples of this row that were added before. Rows
    /// are added several times, because a row is read again for each strip (group of rows) of the image that
    /// needs it. Thread-safe for different rows.
    void begin_row(int y) {
        Row& to = row(y);
        to.first = std::numeric_limits<int>::max();
        to.last = std::numeric_limits<int>::min();
        to.far.clear();
        to.begins.assign(static_cast<std::size_t>(blocks_), 0);
        to.ends = to.begins;
    }
    void add(int y, const Item& item, int first, int last) {
        Row& to = row(y);
        const int from = std::max(0, block_of(first)), to_block = std::min(blocks_ - 1, block_of(last - 1));
        if (from <= to_block) {
            ++to.begins[static_cast<std::size_t>(from)];
            ++to.ends[static_cast<std::size_t>(to_block)];
        }
        if (is_far(y, first, last)) {
            to.far.push_back({item, first, last});
        } else {
            to.include(first, last);
        }
    }
    /// Limits the memory for samples that are kept between strips, because their blur reaches more than
    /// far_px_ rows away. They may need at most `far_bytes`. Samples that this function removes must be added
    /// again for each strip. Call it after complete rows were added.
    void settle() {
        const auto kept = [&] {
            std::size_t out = 0;
            for (const Row& r : rows_) out += r.far.size();
            return out;
        };
        // Doubling far_px_ removes the samples whose blur reaches fewer rows than that.
        while (kept() > far_bytes / sizeof(Far)) {
            far_px_ *= 2;
            for (std::size_t i = 0; i < rows_.size(); ++i) {
                const int y = y_begin_ + static_cast<int>(i);
                Row& r = rows_[i];
                std::erase_if(r.far, [&](const Far& f) {
                    const bool near = !is_far(y, f.first, f.last);
                    if (near) r.include(f.first, f.last);
                    return near;
                });
                r.far.shrink_to_fit();
            }
        }
    }

    /// Returns the ranges [begin, end) of sample rows that must be read to compute the pixel rows [first,
    /// last). A short gap between two ranges is included, because reading it is faster than starting another
    /// read.
    [[nodiscard]] std::vector<std::pair<int, int>> to_be_read(int first, int last) const {
        constexpr int worth_a_gap = 16;
        std::vector<std::pair<int, int>> out;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const Row& r = rows_[i];
            if (r.known() && (r.first >= r.last || r.last <= first || r.first >= last)) continue;
            const int y = y_begin_ + static_cast<int>(i);
            if (!out.empty() && y - out.back().second < worth_a_gap) {
                out.back().second = y + 1;
            } else {
                out.emplace_back(y, y + 1);
            }
        }
        return out;
    }
    /// Returns the number of samples whose blur reaches certain rows of the image: those of the blocks from
    /// `begin` to `end` (exclusive), each of `block_px` rows. Call it only after the samples of all file rows
    /// have been added to this object.
    [[nodiscard]] std::uint64_t reaching(int begin, int end) const {
        std::uint64_t out = 0, gone = 0;
        for (const Row& r : rows_) {
            if (!r.known()) continue;
            out = std::accumulate(r.begins.begin(), r.begins.begin() + end, out);
            gone = std::accumulate(r.ends.begin(), r.ends.begin() + begin, gone);
        }
        return out - gone;
    }
    /// Returns the samples of row y that are kept in memory, because their blur reaches pixels more than
    /// far_px_ rows away. Samples with a smaller blur are not kept, but read again from the file when they
    /// are needed. The samples are in the order in which they were added.
    [[nodiscard]] std::span<const Far> far(int y) const {
        return rows_[static_cast<std::size_t>(y - y_begin_)].far;
    }

  private:
    /// Memory limit, in bytes, for samples whose blur reaches many rows. They stay in memory while the image
    /// is computed strip by strip (groups of rows).
    static constexpr std::size_t far_bytes = std::size_t{32} << 20;

    struct Row {
        int first = 0, last = 0;  ///< pixel rows that the items reach that are not kept
        std::vector<Far> far;
        std::vector<std::uint32_t> begins, ends;  ///< per block, number of items that begin or end in it
        [[nodiscard]] bool known() const { return !begins.empty(); }
        void include(int begin, int end) {
            first = std::min(first, begin);
            last = std::max(last, end);
        }
    };
    [[nodiscard]] Row& row(int y) { return rows_[static_cast<std::size_t>(y - y_begin_)]; }
    [[nodiscard]] bool is_far(int y, int first, int last) const {
        return std::max(y - first, last - y) > far_px_;
    }

    [[nodiscard]] int block_of(int y) const { return y < first_ ? -1 : (y - first_) / block_px_; }

    int y_begin_ = 0;
    int first_ = 0, block_px_ = 1, blocks_ = 0;
    int far_px_ = 32;
    std::vector<Row> rows_;
};

}  // namespace postlens
