// Conditions that every record of a sample file must satisfy, checked both when writing and when reading.
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

/// Positions within a pixel are multiples of 1 / position_steps. Half floats represent them exactly in [0,
/// 1).
inline constexpr int position_steps = 1024;

/// Canonical order inside a pixel: by layer, y, x, path.
[[nodiscard]] bool canonical_before(const Record& a, const Record& b);

/// Describes the first error in the records of pixel (x, y), which must be in canonical order; nullptr if
/// there is none. Conditions:
/// - positions lie inside the pixel and are multiples of 1 / position_steps;
/// - colours and W are finite; z' > 0 and W.bend >= 0, both may be infinite;
/// - paths are valid; no record occurs twice; marks have known bits only;
/// - nodes after a bounce, hidden layers, W.bend and marks occur only if the file has channels for them;
/// - there is a point sample at the upper-left corner of the pixel;
/// - every point sample of layer 0 has a primary node.
[[nodiscard]] const char* problem_of_pixel(std::span<const Record> records, int x, int y,
                                           RecordChannels channels);

}  // namespace postlens
