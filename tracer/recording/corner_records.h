// Sorts the records (shaded surface hits) of a band of pixel rows into the order of a sample file.
#pragma once

#include <cstdint>
#include <vector>

#include "records/record.h"
#include "tracer/recording/corner_grid.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

class CornerRecords {
  public:
    /// Writes the recorded surface points of pixel rows [y_begin, y_end) to `out`, one pixel after another.
    void emit(const CornerGrid& grid, const std::vector<CornerSample>& samples,
              const std::vector<TracedSamples>& chunks, int y_begin, int y_end, RecordBand& out);

  private:
    std::vector<std::uint32_t> first_, order_, next_;  ///< buffers, reused to save allocations
};

}  // namespace postlens
