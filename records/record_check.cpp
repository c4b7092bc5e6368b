#include "records/record_check.h"

#include <cmath>

namespace postlens {
namespace {

bool is_dyadic(float position, int pixel) {
    const float offset = position - static_cast<float>(pixel);
    if (offset == 0) return true;
    const float steps = offset * position_steps;
    // The last condition rejects positions for which the subtraction was rounded.
    return steps > 0 && steps < position_steps && steps == static_cast<float>(static_cast<int>(steps)) &&
           static_cast<float>(pixel) + offset == position;
}

/// x - x is 0 if x is finite, and NaN otherwise. So one comparison tests all three values.
bool all_finite(float a, float b, float c) {
    return (a - a) + (b - b) + (c - c) == 0;
}

const char* problem_of_record(const Record& r, int x, int y, RecordChannels channels) {
    if (!is_dyadic(r.x, x) || !is_dyadic(r.y, y)) {
        return "position is not a multiple of 1/1024 px inside its pixel";
    }
    if (!(r.z > 0)) return "z' is not greater than 0";
    if (!all_finite(r.r, r.g, r.b)) return "colour is not finite";
    if (!r.path.valid()) return "node.path is not a chain of reflections and transmissions";
    if (channels.has_w) {
        if (!all_finite(r.w.xx, r.w.xy, r.w.yx) || !std::isfinite(r.w.yy)) return "W is not finite";
    } else if (r.path.bits() != 0) {
        return "a node behind a bounce needs the W channels";
    }
    if (!(r.w_bend >= 0)) return "W.bend is less than 0";
    if (!channels.has_bend && r.w_bend != 0) return "W.bend needs its channel";
    if ((r.mark & ~RecordMark::all) != 0) return "mark has unknown bits";
    if (!channels.has_marks && r.mark != 0) return "mark needs its channel";
    if (!channels.has_layers && r.layer != 0) return "a hidden surface needs the layer channel";
    return nullptr;
}

}  // namespace

bool canonical_before(const Record& a, const Record& b) {
    if (a.layer != b.layer) return a.layer < b.layer;
    if (a.y != b.y) return a.y < b.y;
    if (a.x != b.x) return a.x < b.x;
    return a.path.bits() < b.path.bits();
}

const char* problem_of_pixel(std::span<const Record> records, int x, int y, RecordChannels channels) {
    if (records.empty() || records[0].layer != 0 || records[0].x != static_cast<float>(x) ||
        records[0].y != static_cast<float>(y)) {
        return "no point sample at the pixel's upper-left corner";
    }
    const Record* previous = nullptr;
    for (const Record& r : records) {
        if (const char* problem = problem_of_record(r, x, y, channels)) return problem;
        if (previous != nullptr && !canonical_before(*previous, r)) {
            return canonical_before(r, *previous) ? "records are not in canonical order"
                                                  : "a record occurs twice";
        }
        const bool begins_sample = previous == nullptr || previous->x != r.x || previous->y != r.y;
        if (r.layer == 0 && begins_sample && r.path.bits() != 0) return "a point sample has no primary node";
        previous = &r;
    }
    return nullptr;
}

}  // namespace postlens
