// Conditions that every record of a sample file must satisfy. They are checked when writing and when reading.
#pragma once

#include <span>

#include "records/record.h"

namespace postlens {

/// Optional channels of the file.
struct RecordChannels {
    bool has_w = false;
    bool has_layers = false;
    bool has_bend = false;  ///< only with W
    bool has_marks = false;
};

/// Positions within a pixel are multiples of 1 / position_steps px. Half floats represent these numbers
/// exactly in [0, 1).
inline constexpr int position_steps = 1024;

/// The canonical order of the records of a pixel: by layer, y, x, path. True if a comes before b.
[[nodiscard]] bool canonical_before(const Record& a, const Record& b);

/// Describes the first error in the records of pixel (x, y); nullptr if there is none. Conditions:
/// - records are in canonical order and none occurs twice;
/// - positions lie inside the pixel and are multiples of 1 / position_steps px;
/// - colours and W are finite; z' > 0 and w_bend >= 0, both may be infinite;
/// - paths are valid; marks have known bits only;
/// - nodes after a bounce, hidden layers, w_bend and marks occur only if the file has channels for them;
/// - there is a point sample at the upper-left corner of the pixel;
/// - every point sample of layer 0 has a primary node.
[[nodiscard]] const char* problem_of_pixel(std::span<const Record> records, int x, int y,
                                           RecordChannels channels);

}  // namespace postlens
