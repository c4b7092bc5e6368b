#include "planner/errors/edge_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pictures/srgb.h"

namespace postlens {
namespace {

/// Limit that distinguishes an edge from smooth shading in a quadtree cell: 0.1 squared. If the squared
/// difference of sRGB values between the corners of the cell is larger, an edge is assumed to cross the cell.
constexpr double least_edge = 0.01;
/// The colours at the corners of a quadtree cell count as equal if their squared difference of sRGB values is
/// below this, 1/255 squared.
constexpr double least_step = 1.5e-5;

}  // namespace

CellCorner cell_corner(const RecordBand& band, const PointSample& s) {
    CellCorner out;
    std::array<float, 3> sum{};
    for (std::uint32_t k = s.first_record; k < s.first_record + s.record_count; ++k) {
        const Record& r = band.records[k];
        if (r.layer != 0) continue;
        sum[0] += r.r, sum[1] += r.g, sum[2] += r.b;
        if (r.path.bits() == 0) {
            out.id = r.id;
            out.inverse_z = std::isfinite(r.z) && r.z > 0 ? 1 / static_cast<double>(r.z) : 0;
        }
    }
    out.linear = sum;
    for (std::size_t c = 0; c < 3; ++c) out.encoded[c] = srgb_from_linear(sum[c]);
    return out;
}

CellStep cell_step(const std::array<const CellCorner*, 4>& corners) {
    CellStep out;
    std::array<double, 4> grey{};
    double widest = -1;
    for (std::size_t k = 1; k < 4; ++k) out.same_id = out.same_id && corners[k]->id == corners[0]->id;
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<double, 4> v{};
        for (std::size_t k = 0; k < 4; ++k) v[k] = static_cast<double>(corners[k]->encoded[c]);
        const auto [low, high] = std::minmax_element(v.begin(), v.end());
        const double step = *high - *low, mixed = v[0] - v[1] - v[2] + v[3];
        out.square += step * step / 3;
        out.curvature_square += mixed * mixed / 3;
        if (step > widest) {
            widest = step;
            const double middle = (*low + *high) / 2;
            for (std::size_t k = 0; k < 4; ++k) grey[k] = v[k] > middle ? 1 : 0;
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        double low = std::numeric_limits<double>::infinity(), high = 0;
        for (const CellCorner* corner : corners) {
            low = std::min(low, static_cast<double>(corner->linear[c]));
            high = std::max(high, static_cast<double>(corner->linear[c]));
        }
        if (high > out.high) out.high = high, out.low = low;
    }
    if (out.square < least_step) return out;
    const bool left_right = grey[0] == grey[2] && grey[1] == grey[3],
               up_down = grey[0] == grey[1] && grey[2] == grey[3];
    out.split = left_right ? CellStep::Split::upright
                : up_down  ? CellStep::Split::level
                           : CellStep::Split::slanted;
    return out;
}

void SpreadLight::add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
                      const FocusGeometry& geometry) {
    if (step.high <= 1) return;
    const double area = size_px * size_px;
    for (const CellCorner* c : corners) {
        const auto light = static_cast<double>(std::max({c->linear[0], c->linear[1], c->linear[2]}));
        if (light > 1) area_ += area / 4;
        light_ += area * std::max(0.0, light - 1) / 4;
        if (light <= brightest_) continue;
        brightest_ = light;
        coc_px_ = std::abs(geometry.coc_diameter_px(c->inverse_z));
    }
    if (step.split == CellStep::Split::none) return;
    const double off = area * (step.high - step.low);
    variance_ += edge_cell_variance * off * off;
    ground_ = std::min(ground_, step.low);
}

double SpreadLight::error(double variance_share) const {
    const double pixels = std::numbers::pi / 4 * coc_px_ * coc_px_;
    if (pixels <= 1 || variance_ <= 0) return 0;
    const double off = std::sqrt(variance_share * variance_), each = light_ / pixels;
    const auto difference = [&](double light, double other) {
        return static_cast<double>(srgb_from_linear(static_cast<float>(ground_ + std::max(0.0, light))) -
                                   srgb_from_linear(static_cast<float>(ground_ + std::max(0.0, other))));
    };
    const double e = difference(each + off / pixels, each - off / pixels) / 2;
    // Estimates a second error, `rim`. The position of the bright light is uncertain by about `moved_px`,
    // because an edge crosses its cells at unknown positions. So the rim of its circle of confusion may be
    // displaced, which changes the colours along the rim.
    const double moved_px = light_ > 0 ? off / light_ * std::sqrt(area_ / std::numbers::pi) : 0;
    constexpr int coverages = 8;
    double rim = 0;
    for (int i = 0; i < coverages; ++i) {
        const double covered = (i + 0.5) / coverages;
        const double moved = difference(each * std::min(1.0, covered + moved_px), each * covered);
        rim += moved * moved / coverages;
    }
    return pixels * e * e + std::numbers::pi * coc_px_ * rim;
}

void PixelEdges::add(const CellStep& s, double size) {
    const double area = size * size;
    // The mean of the cell's four corners is taken as its colour. If the colour contains a x^2 + b y^2 (in a
    // unit cell), this is wrong by (a + b) / 6. The corners do not determine a and b. Therefore, a + b is
    // assumed to equal the coefficient of x y, whose square is `s.curvature_square`.
    if (s.split == CellStep::Split::none || (s.same_id && size == 1 && s.square <= least_edge)) {
        independent_ += area * area * s.curvature_square / 36;
        return;
    }
    sum_ += area * area * s.square;
    const double step = area * std::sqrt(s.square);
    if (s.split == CellStep::Split::upright) upright_ += step;
    if (s.split == CellStep::Split::level) level_ += step;
    if (s.split == CellStep::Split::slanted) ++slanted_;
}

double PixelEdges::mse() const {
    if (slanted_ > 0) return independent_ + edge_cell_variance * sum_;
    return independent_ + aligned_cell_variance * (upright_ * upright_ + level_ * level_);
}

}  // namespace postlens
