// What every record of a sample file must satisfy, checked alike when writing and when reading.
#pragma once

#include <span>

#include "records/record.h"

namespace postlens {

/// What the file has channels for.
struct RecordChannels {
    bool has_w = false;
    bool has_layers = false;
    bool has_bend = false;  ///< only with W
    bool has_marks = false;
};

/// Offsets inside a pixel are multiples of 1 / position_steps: what a half float holds exactly in [0, 1).
inline constexpr int position_steps = 1024;

/// Canonical order inside a pixel: by layer, y, x, path.
[[nodiscard]] bool canonical_before(const Record& a, const Record& b);

/// The first thing wrong with the records of pixel (x, y), in canonical order, or nullptr. Demanded are:
/// positions inside the pixel and dyadic; finite colours and W; z' > 0, infinity allowed; valid paths; no
/// record twice; no deeper node without W channels, no hidden layer without a layer channel, no W.bend or
/// mark but 0 without its channel, no W.bend below 0, infinity allowed; no bits of a mark but known ones; the
/// point sample at the pixel's upper-left corner; a primary node in each point sample of layer 0.
[[nodiscard]] const char* problem_of_pixel(std::span<const Record> records, int x, int y,
                                           RecordChannels channels);

}  // namespace postlens
