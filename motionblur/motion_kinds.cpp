#include "motionblur/motion_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "core/threads.h"

namespace postlens {
namespace {

constexpr int even_probes = 33;

}  // namespace

void IdExtent::add(double x, double y, double inverse_z) {
    add({1, x, x, y, y, inverse_z, inverse_z, inverse_z});
}

void IdExtent::add(const IdExtent& o) {
    if (o.records == 0) return;
    if (records == 0) {
        *this = o;
        return;
    }
    x_min = std::min(x_min, o.x_min);
    x_max = std::max(x_max, o.x_max);
    y_min = std::min(y_min, o.y_min);
    y_max = std::max(y_max, o.y_max);
    inverse_z_min = std::min(inverse_z_min, o.inverse_z_min);
    inverse_z_max = std::max(inverse_z_max, o.inverse_z_max);
    records += o.records;
    inverse_z_sum += o.inverse_z_sum;
}

RasterPoint IdExtent::centre() const {
    return {0.5 * (x_min + x_max), 0.5 * (y_min + y_max),
            records == 0 ? 0 : inverse_z_sum / static_cast<double>(records)};
}

bool add_extents(const RecordBand& band, const std::vector<std::uint32_t>& only, IdExtents& to) {
    constexpr std::size_t grain = 16384;
    std::vector<IdExtents> parts((band.records.size() + grain - 1) / grain);
    parallel_for(parts.size(), [&](std::size_t i) {
        const auto end = std::min((i + 1) * grain, band.records.size());
        std::uint32_t last_id = 0;
        IdExtent* last = nullptr;
        bool looked = false;
        for (std::size_t k = i * grain; k < end; ++k) {
            const Record& r = band.records[k];
            if (r.path.bits() != 0) continue;
            if (!looked || r.id != last_id) {
                last_id = r.id;
                looked = true;
                const bool wanted = only.empty() || std::binary_search(only.begin(), only.end(), r.id);
                last = wanted ? &parts[i][r.id] : nullptr;
            }
            if (last == nullptr) continue;
            last->add(static_cast<double>(r.x), static_cast<double>(r.y),
                      std::isinf(r.z) ? 0 : 1 / static_cast<double>(r.z));
        }
    });
    bool any = false;
    for (const IdExtents& part : parts) {
        for (const auto& [id, extent] : part) {
            to[id].add(extent);
            any = true;
        }
    }
    return any;
}

std::vector<double> probe_times(const std::vector<double>& breaks_s, const Exposure& exposure) {
    std::vector<double> out;
    out.reserve(even_probes + breaks_s.size());
    for (int i = 0; i < even_probes; ++i)
        out.push_back(exposure.open_s + (exposure.close_s - exposure.open_s) * i / (even_probes - 1));
    for (const double t : breaks_s) {
        if (t > exposure.open_s && t < exposure.close_s) out.push_back(t);
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

IdMotion classify(const FrameMotion& motion, std::uint32_t id, const IdExtent& extent, double recorded_s,
                  const Exposure& exposure) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    IdMotion out;
    out.id = id;
    out.centre = extent.centre();
    out.inverse_z = out.centre.inverse_z;
    std::array<std::optional<glm::dvec2>, 8> before;
    std::array<double, 8> paths_px{};
    for (const double t : probe_times(motion.breaks_s(id), exposure)) {
        const RasterMap map = motion.map(id, recorded_s, t);
        const std::optional<RasterPoint> middle = map(out.centre);
        for (int k = 0; k < 8; ++k) {
            const RasterPoint from{(k & 1) != 0 ? extent.x_max : extent.x_min,
                                   (k & 2) != 0 ? extent.y_max : extent.y_min,
                                   (k & 4) != 0 ? extent.inverse_z_max : extent.inverse_z_min};
            const std::optional<RasterPoint> to = map(from);
            if (!to || !middle) {
                out.largest_move_px = out.path_px = out.deviation_px = out.bend_px = infinite;
                break;
            }
            const glm::dvec2 at{to->x, to->y};
            const auto corner = static_cast<std::size_t>(k);
            paths_px[corner] += glm::distance(at, before[corner].value_or(at));
            before[corner] = at;
            out.path_px = std::max(out.path_px, paths_px[corner]);
            const double dx = to->x - from.x, dy = to->y - from.y;
            out.largest_move_px = std::max(out.largest_move_px, std::hypot(dx, dy));
            const double middle_dx = middle->x - out.centre.x, middle_dy = middle->y - out.centre.y;
            out.deviation_px = std::max(out.deviation_px, std::hypot(dx - middle_dx, dy - middle_dy));
            const double nearer = out.inverse_z > 0 ? from.inverse_z / out.inverse_z : 1;
            out.bend_px = std::max(out.bend_px, std::hypot(dx - nearer * middle_dx, dy - nearer * middle_dy));
        }
    }
    if (!(out.largest_move_px >= still_px)) {
        out.kind = MotionKind::still;
    } else {
        out.kind = out.deviation_px <= translation_px ? MotionKind::translation
                   : out.bend_px <= translation_px    ? MotionKind::parallax
                                                      : MotionKind::general;
    }
    return out;
}

std::vector<std::uint32_t> moving_ids(const std::vector<IdMotion>& ids) {
    std::vector<std::uint32_t> out;
    for (const IdMotion& m : ids) {
        if (m.kind != MotionKind::still) out.push_back(m.id);
    }
    return out;
}

std::string name_of(const SampleHeader& header, std::uint32_t id) {
    const auto found = header.object_names.find(id);
    if (found != header.object_names.end()) return found->second;
    return id == 0 ? "background" : "";
}

std::string label_of(const SampleHeader& header, std::uint32_t id) {
    const std::string name = name_of(header, id);
    return name.empty() ? std::to_string(id) : name;
}

}  // namespace postlens
