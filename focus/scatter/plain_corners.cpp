#include "focus/scatter/plain_corners.h"

#include <algorithm>

#include "focus/responses/node_response.h"

namespace postlens {

void find_plain_corners(const RecordBand& band, const PointSamples& samples, PlainCorners& out) {
    const auto width = static_cast<std::size_t>(band.width());
    const std::size_t pixels = samples.offsets.size() - 1;
    out.inverse_depth.assign(pixels, PlainCorners::not_plain);
    for (auto* plane : {&out.r, &out.g, &out.b}) plane->assign(pixels, 0.0F);
    out.rows.assign(pixels / width, {});
    out.others.clear();
    out.other_begin.assign(1, 0);
    for (std::size_t row = 0; row < out.rows.size(); ++row) {
        PlainCorners::Row& facts = out.rows[row];
        for (std::uint32_t i = samples.offsets[row * width]; i < samples.offsets[(row + 1) * width]; ++i) {
            const PointSample& s = samples.samples[i];
            const auto nodes = std::span(band.records).subspan(s.first_record, s.record_count);
            if (!is_whole_corner(s) || !std::all_of(nodes.begin() + 1, nodes.end(), is_dark)) {
                out.others.push_back(i);
                continue;
            }
            const std::size_t at =
                row * width + static_cast<std::size_t>(static_cast<int>(s.x) - band.x_begin);
            const Record& node = nodes[0];
            const double inverse = inverse_depth_per_m(node);
            out.inverse_depth[at] = inverse;
            out.r[at] = node.r;
            out.g[at] = node.g;
            out.b[at] = node.b;
            facts.negative |= node.r < 0 || node.g < 0 || node.b < 0;
            if (!(inverse > 0)) continue;
            facts.least_inverse = std::min(facts.least_inverse, inverse);
            facts.greatest_inverse = std::max(facts.greatest_inverse, inverse);
        }
        out.other_begin.push_back(static_cast<std::uint32_t>(out.others.size()));
    }
}

}  // namespace postlens
