#include "motionblur/groups/slice_rule.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "core/threads.h"
#include "motionblur/groups/depth_slices.h"

namespace postlens {
namespace {

bool may_interleave(const MovingGroup& a, const MovingGroup& b) {
    const PassedBox p = passed_box(a), q = passed_box(b);
    const bool meet = p.low_px.x <= q.high_px.x && q.low_px.x <= p.high_px.x && p.low_px.y <= q.high_px.y &&
                      q.low_px.y <= p.high_px.y;
    return meet && a.extent.inverse_z_min <= b.extent.inverse_z_max &&
           b.extent.inverse_z_min <= a.extent.inverse_z_max;
}

}  // namespace

PassedBox passed_box(const MovingGroup& group) {
    glm::dvec2 back(0), forth(0);
    const double scale = group.has_parallax ? group.extent.inverse_z_max / group.path_inverse_z : 1;
    for (const PathPoint& p : group.path) {
        back = glm::min(back, scale * p.at_px);
        forth = glm::max(forth, scale * p.at_px);
    }
    const IdExtent& e = group.extent;
    return {glm::dvec2(e.x_min, e.y_min) + back, glm::dvec2(e.x_max, e.y_max) + forth};
}

double share_among(const std::vector<BandSurfaces>& bands, const GroupTable& table,
                   const MovingGroup& group) {
    // Relative tolerance for depths, which the file stores as rounded floats.
    constexpr double rounding = 1e-5;
    const double far = group.extent.inverse_z_min * (1 + rounding),
                 near = group.extent.inverse_z_max * (1 - rounding);
    const PassedBox box = passed_box(group);
    std::vector<double> sums(bands.size(), 0);
    parallel_for(bands.size(), [&](std::size_t b) {
        const BandSurfaces& band = bands[b];
        const auto lies_among = [&](std::uint32_t sample) {
            for (std::uint32_t i = band.surfaces.offsets[sample]; i < band.surfaces.offsets[sample + 1];
                 ++i) {
                const LayerSurface& s = band.surfaces.surfaces[i];
                const auto inverse_z = static_cast<double>(s.inverse_z);
                if (inverse_z > far && inverse_z < near && table(s.id) < 0) return true;
            }
            return false;
        };
        const int x_end = std::min(static_cast<int>(std::ceil(box.high_px.x)), band.x_begin + band.width - 1),
                  y_end = std::min(static_cast<int>(std::ceil(box.high_px.y)), band.y_end);
        for (int y = std::max(static_cast<int>(std::floor(box.low_px.y)), band.y_begin); y < y_end; ++y) {
            for (int x = std::max(static_cast<int>(std::floor(box.low_px.x)), band.x_begin); x < x_end; ++x) {
                band.for_each_leaf(x, y, [&](const Leaf& leaf) {
                    const auto quarter = static_cast<double>(leaf.size) * static_cast<double>(leaf.size) / 4;
                    for (const std::uint32_t corner : leaf.corner)
                        sums[b] += lies_among(corner) ? quarter : 0;
                });
            }
        }
    });
    const glm::dvec2 size = glm::max(box.high_px - box.low_px, glm::dvec2(1));
    return std::accumulate(sums.begin(), sums.end(), 0.0) / (size.x * size.y);
}

std::string why_not_sliced(const std::vector<MovingGroup>& groups, std::size_t g, const GroupTable& table,
                           const std::vector<BandSurfaces>& bands, const SampleHeader& header) {
    const MovingGroup& group = groups[g];
    if (const double px = parallax_px(group); px > most_parallax_px)
        return fmt::format("its parts differ by {:.0f} px", px);
    for (std::size_t other = 0; other < groups.size(); ++other) {
        if (other != g && may_interleave(group, groups[other]))
            return fmt::format("{} moves in the same depth", label_of(header, groups[other].ids.front()));
    }
    if (const double share = share_among(bands, table, group); share > most_among)
        return fmt::format("something else lies in its depth on {:.1f} % of its way", 100 * share);
    const double torn = torn_share(bands, table, static_cast<int>(g), group, across_per_px(header));
    if (torn > most_torn)
        return fmt::format("its parts uncover each other, by {:.1f} % of its area", 100 * torn);
    return "";
}

}  // namespace postlens
