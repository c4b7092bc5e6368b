#include "tracer/shading_trees/bend_around.h"

#include <algorithm>
#include <limits>

namespace postlens {
namespace {

/// Returns the record (stored surface hit) of a sample that has the given path, i.e. the given sequence of
/// bounces, and the given layer. Layer 0 holds the visible surfaces, and each further layer holds what
/// belongs to one hidden surface. If this surface is hidden behind others in a mirror, its layer has no
/// record for the mirror itself, because layer 0 contains it. In this case, the record in layer 0 is
/// returned.
const Record* find_node(std::span<const Record> records, std::uint32_t layer, NodePath path) {
    const Record* visible = nullptr;
    for (const Record& r : records) {
        if (r.path != path) continue;
        if (r.layer == layer) return &r;
        if (r.layer == 0) visible = &r;
    }
    return visible;
}

bool seen_in_the_same(std::span<const Record> records, const Record& r, const ChainNode& node) {
    NodePath path = r.path;
    for (std::size_t bounce = node.ids.size(); bounce-- > 0;) {
        path = path.parent();
        const Record* in = find_node(records, r.layer, path);
        if (in == nullptr || in->id != node.ids[bounce]) return false;
    }
    return true;
}

/// Summarizes what one neighbouring sample tells about `w_bend` of a given surface hit. `w_bend` is a measure
/// of how nonlinearly the image of a mirrored or refracted surface moves when the lens point moves. Only some
/// hits of the sample count: those that are seen by the same bounces at the same mirrors and glass objects as
/// the given hit. In addition, they must be visible if it is visible, and hidden if it is hidden.
struct Seen {
    float greatest = 0;  ///< greatest `w_bend` of these records, 1/m^2
    bool any = false;    ///< there is such a record
    bool same = false;   ///< one of these records lies on the same object as the given node
};

Seen seen_by(std::span<const Record> records, const ChainNode& node) {
    Seen out;
    for (const Record& r : records) {
        if (r.path != node.path || (r.layer != 0) != node.hidden || !seen_in_the_same(records, r, node))
            continue;
        out.any = true;
        out.same = out.same || r.id == node.id;
        out.greatest = std::max(out.greatest, r.w_bend);
    }
    return out;
}

}  // namespace

std::optional<float> bend_around(const SamplesAround& around, const ChainNode& node, float little) {
    constexpr float smooth = 2;
    float greatest = 0, least = std::numeric_limits<float>::infinity();
    bool one_same = false, all_same = true;
    for (const std::span<const Record> records : around) {
        const Seen seen = seen_by(records, node);
        if (!seen.any) return std::nullopt;
        one_same = one_same || seen.same;
        all_same = all_same && seen.same;
        greatest = std::max(greatest, seen.greatest);
        least = std::min(least, seen.greatest);
        if (!(greatest <= little) && !(all_same && greatest <= smooth * least)) return std::nullopt;
    }
    return one_same ? std::optional(greatest) : std::nullopt;
}

}  // namespace postlens
