// How large a sample file will be, from a look at a few rows.
#pragma once

#include <cstdint>

#include "records/sample_file.h"
#include "tracer/corner_sampler.h"

namespace postlens {

/// Rows that the look traces of a window of so many: 2 in about 100, at least 8 where there are as many.
[[nodiscard]] int looked_at_rows(int rows);

/// Bytes of a sample file of `instants` instants as dense as this one: of pairs of rows, evenly spread, that
/// are traced and packed as the file's will be. The header does not count.
[[nodiscard]] std::uint64_t expected_file_bytes(const WhittedTracer& tracer, const SampledWindow& window,
                                                const SubdivisionSettings& subdivision,
                                                const SmallThings& things, const SampleHeader& header,
                                                RecordCompression compression, std::size_t instants);

}  // namespace postlens
