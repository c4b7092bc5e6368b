// Conditions for every record of a sample file. They are checked when a file is written and when it is read.
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

/// Positions within a pixel are multiples of 1 / position_steps px, which half floats represent exactly.
inline constexpr int position_steps = 1024;

/// Returns whether record a is stored before record b in a pixel. Records are sorted by layer (0 if the
/// pinhole sees the surface, larger if it is hidden), then by y, x, and path (the reflections and
/// transmissions by which the surface is seen).
[[nodiscard]] bool canonical_before(const Record& a, const Record& b);

/// Describes the first error in the records of pixel (x, y). Returns null if all of these conditions hold:
/// - The records are in canonical order, and no record occurs twice.
/// - Positions lie inside the pixel and are multiples of 1 / position_steps px.
/// - Colours and W are finite. z' is positive and w_bend is not negative; both may be infinite.
/// - Paths are valid, and marks have only known bits.
/// - Nodes after a bounce, hidden layers, w_bend and marks occur only if the file has channels for them.
/// - There is a point sample at the upper-left corner of the pixel.
/// - Every point sample of layer 0 has a primary node.
[[nodiscard]] const char* problem_of_pixel(std::span<const Record> records, int x, int y,
                                           RecordChannels channels);

}  // namespace postlens
