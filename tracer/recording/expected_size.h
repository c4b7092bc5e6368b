// Predicts the size of a sample file from a preview pass, which traces a few rows.
#pragma once

#include <cstdint>

#include "records/sample_file.h"
#include "tracer/recording/corner_sampler.h"

namespace postlens {

/// Returns how many of a window's `rows` rows the preview pass traces: 2 of every 96, but 8 to 64.
/// It is at most `rows`.
[[nodiscard]] int looked_at_rows(int rows);

/// Returns the predicted size of a sample file, in bytes, without its header.
/// It is extrapolated from evenly spaced pairs of rows to all rows and recorded instants.
[[nodiscard]] std::uint64_t expected_file_bytes(const WhittedTracer& tracer, const SampledWindow& window,
                                                const SubdivisionSettings& subdivision,
                                                const SmallThings& things, const SampleHeader& header,
                                                RecordCompression compression, std::size_t instants);

}  // namespace postlens
