// Predicts the size of a sample file by tracing a few rows first (preview pass).
#pragma once

#include <cstdint>

#include "records/sample_file.h"
#include "tracer/recording/corner_sampler.h"

namespace postlens {

/// Returns how many of the `rows` pixel rows are traced to predict the size of a sample file. It is about
/// rows / 48, but at least 8 and at most 64, and never more than `rows`.
[[nodiscard]] int looked_at_rows(int rows);

/// Returns the predicted size of a sample file, in bytes, without its header.
/// Traces some stripes of two rows, evenly spaced over the image, and extrapolates their size to all rows and
/// all recorded instants.
[[nodiscard]] std::uint64_t expected_file_bytes(const WhittedTracer& tracer, const SampledWindow& window,
                                                const SubdivisionSettings& subdivision,
                                                const SmallThings& things, const SampleHeader& header,
                                                RecordCompression compression, std::size_t instants);

}  // namespace postlens
