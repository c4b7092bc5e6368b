#include "compare/lens_search/recorded_depths.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

/// Number of rows that are read at a time.
constexpr int rows_per_band = 64;
/// A pixel is a depth edge if it contains surfaces at different depths that are blurred differently: the
/// circles of confusion of the nearest and the farthest differ by at least this many px in diameter.
constexpr double edge_px = 1;
/// Margin, in px, that is added to the radius of a circle of confusion to find the pixels that its light may
/// reach. The light may go from one corner of a pixel to a corner of another, which adds half the diagonal of
/// each pixel, in total 1.41 px.
constexpr double margin_px = 1.5;

std::size_t index_of(const RecordedDepths& d, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(d.width) + static_cast<std::size_t>(x);
}

/// Adds a record to its pixel. A record on the border of two pixels is added to both.
void add(RecordedDepths& out, const Record& r, int x, int y) {
    const float inverse = 1 / r.z;
    for (int py = y - (r.y == static_cast<float>(y) ? 1 : 0); py <= y; ++py) {
        for (int px = x - (r.x == static_cast<float>(x) ? 1 : 0); px <= x; ++px) {
            if (px < 0 || py < 0 || px >= out.width || py >= out.height) continue;
            const std::size_t k = index_of(out, px, py);
            out.nearest_per_m[k] = std::max(out.nearest_per_m[k], inverse);
            out.farthest_per_m[k] = std::min(out.farthest_per_m[k], inverse);
        }
    }
}

}  // namespace

double RecordedDepths::nearest() const {
    return static_cast<double>(*std::max_element(nearest_per_m.begin(), nearest_per_m.end()));
}

double RecordedDepths::farthest() const {
    return static_cast<double>(*std::min_element(farthest_per_m.begin(), farthest_per_m.end()));
}

double RecordedDepths::largest_coc_px(const FocusGeometry& geometry) const {
    return std::max(std::abs(geometry.coc_diameter_px(nearest())),
                    std::abs(geometry.coc_diameter_px(farthest())));
}

RecordedDepths recorded_depths(const SampleFileReader& file) {
    const SampleHeader& h = file.header();
    RecordedDepths out{.width = h.width, .height = h.height, .overscan_px = h.overscan_px};
    const std::size_t pixels = static_cast<std::size_t>(h.width) * static_cast<std::size_t>(h.height);
    out.nearest_per_m.assign(pixels, 0);
    out.farthest_per_m.assign(pixels, std::numeric_limits<float>::infinity());
    RecordBand band;
    for (int begin = 0; begin <= h.height; begin += rows_per_band) {
        const int end = std::min(begin + rows_per_band, h.height + 1);
        file.read(begin, end, band);
        for (int y = begin; y < end; ++y) {
            for (int x = 0; x <= h.width; ++x) {
                const std::size_t k = band.pixel(x, y);
                for (std::uint32_t i = band.offsets[k]; i < band.offsets[k + 1]; ++i) {
                    const Record& r = band.records[i];
                    if (r.layer == 0 && r.path.bits() == 0) add(out, r, x, y);
                }
            }
        }
    }
    return out;
}

std::vector<char> reliable_pixels(const RecordedDepths& d, const FocusGeometry& geometry) {
    std::vector<char> out(d.nearest_per_m.size(), 1);
    const double beyond_px = d.largest_coc_px(geometry) / 2 + 1 - d.overscan_px;
    for (int y = 0; y < d.height; ++y) {
        for (int x = 0; x < d.width; ++x) {
            const std::size_t k = index_of(d, x, y);
            const int inside_px = std::min({x, y, d.width - 1 - x, d.height - 1 - y});
            if (inside_px < beyond_px) out[k] = 0;
            const double near_px = geometry.coc_diameter_px(static_cast<double>(d.nearest_per_m[k]));
            const double far_px = geometry.coc_diameter_px(static_cast<double>(d.farthest_per_m[k]));
            if (far_px - near_px < edge_px) continue;
            const double radius_px = std::max(std::abs(near_px), std::abs(far_px)) / 2 + margin_px;
            const int rows = static_cast<int>(std::min(radius_px, static_cast<double>(d.height)));
            for (int row = std::max(0, y - rows); row <= std::min(d.height - 1, y + rows); ++row) {
                const double half = std::sqrt(radius_px * radius_px - (row - y) * (row - y));
                const int half_px = static_cast<int>(std::min(half, static_cast<double>(d.width)));
                const int first = std::max(0, x - half_px), last = std::min(d.width - 1, x + half_px);
                std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(index_of(d, first, row)),
                            last - first + 1, 0);
            }
        }
    }
    return out;
}

}  // namespace postlens
