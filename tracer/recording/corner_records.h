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
    /// Writes the records of rows [y_begin, y_end), pixel by pixel, to `out`. Call sort() first, with the
    /// same `samples` and a range of rows that contains these rows.
    void emit(const CornerGrid& grid, std::span<const CornerSample> samples,
              const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out);

  private:
    int y_begin_ = 0;  ///< first row
    /// `order_` lists indices of samples, pixel by pixel. For each pixel, `first_` is the position in
    /// `order_` of its first sample, and `first_record_` is its first record.
    std::vector<std::uint32_t> first_, order_, first_record_;
    std::vector<std::uint32_t> next_;  ///< buffer
};

}  // namespace postlens
