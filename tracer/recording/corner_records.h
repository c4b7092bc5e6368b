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
    /// Writes the records of pixel rows [y_begin, y_end), one pixel after the other.
    void emit(const CornerGrid& grid, std::span<const CornerSample> samples,
              const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out);

  private:
    std::vector<std::uint32_t> first_, order_, next_;  ///< buffers, reused to save allocations
};

}  // namespace postlens
