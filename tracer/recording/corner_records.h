// Sorts the records (shaded surface hits) of a band of pixel rows by pixel, as the sample file needs them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "records/record.h"
#include "tracer/recording/corner_grid.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

class CornerRecords {
  public:
    /// Sorts the samples of pixel rows [y_begin, y_end) by pixel.
    void sort(const CornerGrid& grid, std::span<const CornerSample> samples, int y_begin, int y_end);
    /// Writes the records (surface hits) of the pixel rows y_begin to y_end - 1 to `out`, pixel by pixel.
    /// sort() must have been called before, with the same `samples` and with a range of rows that contains
    /// these rows.
    void emit(const CornerGrid& grid, std::span<const CornerSample> samples,
              const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out);

  private:
    int y_begin_ = 0;  ///< first row
    /// `order_` lists the indices of all samples, sorted by the pixel in which they lie. For each pixel,
    /// `first_` holds the position of its first sample in `order_`. Each sample has several records (surface
    /// hits). `first_record_` holds the number of records of all pixels before this pixel, and so the index
    /// of its first record.
    std::vector<std::uint32_t> first_, order_, first_record_;
    std::vector<std::uint32_t> next_;  ///< buffer
};

}  // namespace postlens
