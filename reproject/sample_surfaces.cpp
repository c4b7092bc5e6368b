#include "reproject/sample_surfaces.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// A surface that slopes more than this against the film, as tangent, is taken for two, one behind the other.
constexpr double steepest_slope = 40;

/// The surface of the nodes that begin at `r` and share its place and layer; leaves `r` behind them.
bool take_surface(const Record*& r, const Record* end, Surface& out) {
    const Record& primary = *r;
    const bool known = primary.path.bits() == 0;
    out = {std::isinf(primary.z) ? 0.0F : 1 / primary.z, 0, 0, 0, primary.id};
    double red = 0, green = 0, blue = 0;
    for (; r != end && r->layer == primary.layer && r->x == primary.x && r->y == primary.y; ++r) {
        red += static_cast<double>(r->r);
        green += static_cast<double>(r->g);
        blue += static_cast<double>(r->b);
    }
    out.r = static_cast<float>(red);
    out.g = static_cast<float>(green);
    out.b = static_cast<float>(blue);
    return known;
}

}  // namespace

bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective) {
    if (high_inverse_z == low_inverse_z) return true;
    // Slope: depth over width, both at the nearer end; dz / z = relative step of 1/z, width = z tan.
    const auto near = static_cast<double>(high_inverse_z), far = static_cast<double>(low_inverse_z);
    if (perspective) return (near - far) / near <= steepest_slope * across;
    return far > 0 && 1 / far - 1 / near <= steepest_slope * across;
}

double across_per_px(const SampleHeader& h) {
    return h.projection == Projection::perspective ? h.pixel_pitch_mm / h.film_distance_mm
                                                   : h.pixel_pitch_mm * 1e-3;
}

void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out) {
    struct Hidden {
        std::uint32_t sample = 0;
        Surface surface;
    };
    thread_local std::vector<Hidden> hidden;
    out.surfaces.clear();
    out.offsets.assign(1, 0);
    const std::size_t pixels = points.offsets.size() - 1;
    const std::size_t first_pixel = band.pixel(band.x_begin, y_begin);
    const Record* records = band.records.data();
    for (std::size_t k = 0; k < pixels; ++k) {
        const std::uint32_t begin = points.offsets[k], end = points.offsets[k + 1];
        // Behind the records of layer 0 come those of the deeper layers, each by (y, x) again.
        const PointSample& last = points.samples[end - 1];
        const Record* r = records + last.first_record + last.record_count;
        const Record* pixel_end = records + band.offsets[first_pixel + k + 1];
        hidden.clear();
        std::uint32_t at = begin;
        for (std::uint32_t layer = 0; r != pixel_end;) {
            if (r->layer != layer) at = begin;
            layer = r->layer;
            while (at < end && (points.samples[at].y < r->y ||
                                (points.samples[at].y == r->y && points.samples[at].x < r->x)))
                ++at;
            const bool of_sample = at < end && points.samples[at].x == r->x && points.samples[at].y == r->y;
            Surface surface;
            if (take_surface(r, pixel_end, surface) && of_sample) hidden.push_back({at, surface});
        }
        std::stable_sort(hidden.begin(), hidden.end(),
                         [](const Hidden& a, const Hidden& b) { return a.sample < b.sample; });
        auto next = hidden.cbegin();
        for (std::uint32_t i = begin; i < end; ++i) {
            const PointSample& s = points.samples[i];
            const Record* node = records + s.first_record;
            Surface surface;
            if (take_surface(node, node + s.record_count, surface)) out.surfaces.push_back(surface);
            for (; next != hidden.cend() && next->sample == i; ++next) out.surfaces.push_back(next->surface);
            out.offsets.push_back(static_cast<std::uint32_t>(out.surfaces.size()));
        }
    }
}

}  // namespace postlens
