// Sorts the records (shaded surface hits) of a band of pixel rows into the order of a sample file.
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
    /// Writes the records of some of these rows, one pixel after the other. `samples` must be the same.
    void emit(const CornerGrid& grid, std::span<const CornerSample> samples,
              const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out);

  private:
    int y_begin_ = 0;  ///< first row
    /// For each pixel, its first sample in `order_`, which lists indices of samples, and its first record.
    std::vector<std::uint32_t> first_, order_, first_record_;
    std::vector<std::uint32_t> next_;  ///< buffer
};

}  // namespace postlens
