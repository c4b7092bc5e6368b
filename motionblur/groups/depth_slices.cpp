#include "motionblur/groups/depth_slices.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/memory.h"
#include "core/threads.h"
#include "motionblur/groups/group_raster.h"

namespace postlens {
namespace {

using glm::dvec2;

/// A moving object with parallax is divided into depth slices, each of which moves as a whole. This is the
/// largest accepted difference, in px, between the displacements of neighbouring slices. Smaller differences
/// need more slices but do not increase the PSNR.
constexpr double step_px = 4;

/// Returns the gradient of the inverse depth across `leaf` (a pixel or a part of it), in 1/m per px.
dvec2 gradient_of(const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) {
    const auto slope = [&](std::size_t a0, std::size_t a1, std::size_t b0, std::size_t b1) {
        double sum = 0;
        int known = 0;
        for (const auto& [from, to] : {std::pair(s[a0], s[a1]), std::pair(s[b0], s[b1])}) {
            if (from == nullptr || to == nullptr) continue;
            sum += static_cast<double>(to->inverse_z) - static_cast<double>(from->inverse_z);
            ++known;
        }
        return known == 0 ? 0.0 : sum / (known * static_cast<double>(leaf.size));
    };
    return {slope(0, 1, 2, 3), slope(0, 2, 1, 3)};
}

bool is_torn(const Leaf& leaf, const std::array<const LayerSurface*, 4>& s, double across_per_px) {
    float low = std::numeric_limits<float>::infinity(), high = 0;
    for (const LayerSurface* corner : s) {
        if (corner == nullptr) continue;
        low = std::min(low, corner->inverse_z);
        high = std::max(high, corner->inverse_z);
    }
    return low < high && !is_one_surface(low, high, static_cast<double>(leaf.size) * across_per_px, true);
}

}  // namespace

int slices_for(const MovingGroup& group) {
    const double steps = std::ceil(parallax_px(group) / step_px);
    return 1 + static_cast<int>(std::clamp(steps, 1.0, most_slices - 1.0));
}

double torn_share(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                  const MovingGroup& group, double across_per_px) {
    const CellWindow pixels = group_window(bands, group, 1);
    const std::vector<PathAxis> axes = axes_of(group);
    struct Sum {
        double torn = 0, all = 0;
    };
    std::vector<Sum> sums(bands.size());
    parallel_for(bands.size(), [&](std::size_t b) {
        for_each_leaf_of(bands[b], table, g, pixels, 1,
                         [&](const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) {
                             const auto size = static_cast<double>(leaf.size);
                             const auto corners = 4 - std::count(s.begin(), s.end(), nullptr);
                             sums[b].all += size * size * static_cast<double>(corners) / 4;
                             if (!is_torn(leaf, s, across_per_px)) return;
                             const dvec2 gradient = gradient_of(leaf, s);
                             double apart_px = 0;  // distance by which the motion separates the leaf's sides
                             for (const PathAxis& axis : axes)
                                 apart_px =
                                     std::max(apart_px, size / group.path_inverse_z *
                                                            std::abs(glm::dot(gradient, axis.direction)) *
                                                            std::max(axis.high_px, -axis.low_px));
                             constexpr double noticeable_px = 0.5;
                             if (apart_px >= noticeable_px) sums[b].torn += size * apart_px;
                         });
    });
    Sum sum;
    for (const Sum& s : sums) {
        sum.torn += s.torn;
        sum.all += s.all;
    }
    return sum.all > 0 ? sum.torn / sum.all : 0;
}

std::vector<PathAxis> axes_of(const MovingGroup& group) {
    dvec2 farthest(0);
    for (const PathPoint& p : group.path) {
        if (glm::length(p.at_px) > glm::length(farthest)) farthest = p.at_px;
    }
    if (farthest == dvec2(0)) return {};
    const dvec2 along = glm::normalize(farthest);
    std::vector<PathAxis> out{{along, 0, 0}, {{-along.y, along.x}, 0, 0}};
    for (PathAxis& axis : out) {
        axis.low_px = axis.high_px = glm::dot(group.path.front().at_px, axis.direction);
        for (const PathPoint& p : group.path) {
            axis.low_px = std::min(axis.low_px, glm::dot(p.at_px, axis.direction));
            axis.high_px = std::max(axis.high_px, glm::dot(p.at_px, axis.direction));
        }
    }
    constexpr double straight_px = 1;
    if (std::max(-out[1].low_px, out[1].high_px) <= straight_px) out.pop_back();
    return out;
}

Stretch stretch_of(const dvec2& rate_per_px, const std::vector<PathAxis>& axes) {
    double low = 0, high = 0;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const double rate = rate_per_px[static_cast<int>(a)];
        low += std::min(rate * axes[a].low_px, rate * axes[a].high_px);
        high += std::max(rate * axes[a].low_px, rate * axes[a].high_px);
    }
    if (low >= -1) return {1, rate_per_px};
    if (high <= -1) return {0, {}};
    // During the motion, the area of a surface element in the image is multiplied by 1 + v, where v is linear
    // in the displacement and lies between `low` and `high`. If v < -1, the element faces away and is
    // invisible, so the true factor is max(0, 1 + v). But only factors that are linear in v can be drawn. So
    // area * (1 - v / low) is used, which is 0 at v = low. `area` is chosen so that both factors have the
    // same mean over all v from `low` to `high`.
    const double area = (1 + high) * (1 + high) / ((high - low) * (1 - high / low));
    return {area, area / -low * rate_per_px};
}

DepthSlices::DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                         const MovingGroup& group, int cells_per_px, double across_per_px)
    : count_(slices_for(group)),
      cells_per_px_(cells_per_px),
      far_(group.extent.inverse_z_min),
      step_((group.extent.inverse_z_max - group.extent.inverse_z_min) / (count_ - 1)),
      path_inverse_z_(group.path_inverse_z),
      across_per_px_(across_per_px),
      window_(group_window(bands, group, cells_per_px)),
      axes_(axes_of(group)),
      bands_(bands.size()) {
    // Checks an upper estimate of the memory for the pieces of this group. A piece is the quarter of a
    // quadtree leaf at one of its corners. A sample is a corner of about four leaves, so there are about four
    // pieces for each record.
    require_memory(4 * group.extent.records * (sizeof(Piece) + sizeof(std::uint32_t)),
                   "the slices of a moving object");
    parallel_for(bands.size(), [&](std::size_t b) { collect(bands[b], table, g, bands_[b]); });
}

double DepthSlices::path_scale(int k) const {
    return (far_ + k * step_) / path_inverse_z_;
}

Stretch DepthSlices::leaf_stretch(const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) const {
    if (is_torn(leaf, s, across_per_px_)) return {};
    const dvec2 gradient = gradient_of(leaf, s);
    dvec2 rate(0);
    for (std::size_t a = 0; a < axes_.size(); ++a)
        rate[static_cast<int>(a)] = glm::dot(gradient, axes_[a].direction) / path_inverse_z_;
    return stretch_of(rate, axes_);
}

void DepthSlices::collect(const BandSurfaces& band, const GroupTable& table, int g, BandPieces& out) const {
    out.pieces.reserve(4 * band.leaves.leaves.size());
    for_each_leaf_of(band, table, g, window_, cells_per_px_,
                     [&](const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) {
                         const PointSample& at = band.leaves.points.samples[leaf.corner[0]];
                         const Stretch stretch = leaf_stretch(leaf, s);
                         Piece piece;
                         double area = stretch.area;
                         for (std::size_t a = 0; a < axes_.size(); ++a) {
                             const double rate = stretch.rate_per_px[static_cast<int>(a)];
                             area += rate * axes_[a].low_px;
                             piece.rate[a] = static_cast<float>(rate);
                         }
                         piece.area = static_cast<float>(area);
                         for (std::size_t k = 0; k < 4; ++k) {
                             if (s[k] == nullptr) continue;
                             const QuarterCells q = quarter_cells(at, leaf.size, k, cells_per_px_);
                             const double place = std::clamp(
                                 (static_cast<double>(s[k]->inverse_z) - far_) / step_, 0.0, count_ - 1.0);
                             const int slice = std::min(static_cast<int>(place), count_ - 2);
                             piece.x = q.x - window_.x_begin;
                             piece.y = q.y - window_.y_begin;
                             piece.n = q.n;
                             piece.share = q.share;
                             piece.r = s[k]->r;
                             piece.g = s[k]->g;
                             piece.b = s[k]->b;
                             piece.nearer = static_cast<float>(place - slice);
                             piece.slice = slice;
                             out.pieces.push_back(piece);
                         }
                     });
    out.offsets.assign(static_cast<std::size_t>(count_) + 1, 0);
    for (const Piece& piece : out.pieces) ++out.offsets[static_cast<std::size_t>(piece.slice) + 1];
    for (std::size_t k = 1; k < out.offsets.size(); ++k) out.offsets[k] += out.offsets[k - 1];
    std::vector<std::size_t> next = out.offsets;
    out.order.resize(out.pieces.size());
    for (std::uint32_t i = 0; i < out.pieces.size(); ++i)
        out.order[next[static_cast<std::size_t>(out.pieces[i].slice)]++] = i;
}

SliceRaster DepthSlices::draw(int k) const {
    Planes empty{window_.x_begin, window_.y_begin, window_.width(), window_.height(), {}};
    const auto width = static_cast<std::size_t>(empty.width);
    const std::size_t cells = width * static_cast<std::size_t>(empty.height);
    require_memory(cells * 4 * sizeof(float) * (2 + axes_.size()), "a slice of a moving object");
    empty.planes.assign(4, std::vector<float>(cells, 0));
    SliceRaster out{empty, std::vector<Planes>(axes_.size(), empty)};
    const auto add = [&](const Piece& p, float share) {
        const std::array<float, 4> values{p.r * share, p.g * share, p.b * share, share};
        for (int j = 0; j < p.n; ++j) {
            const std::size_t row = static_cast<std::size_t>(p.y + j) * width + static_cast<std::size_t>(p.x);
            for (std::size_t i = row; i < row + static_cast<std::size_t>(p.n); ++i) {
                for (std::size_t plane = 0; plane < 4; ++plane) {
                    out.flat.planes[plane][i] += p.area * values[plane];
                    for (std::size_t a = 0; a < axes_.size(); ++a)
                        out.stretched[a].planes[plane][i] += p.rate[a] * values[plane];
                }
            }
        }
    };
    parallel_for(bands_.size(), [&](std::size_t b) {
        const BandPieces& band = bands_[b];
        if (band.pieces.empty()) return;
        const auto slice = static_cast<std::size_t>(k);
        const auto add_all = [&](std::size_t of, const auto& share) {
            for (std::size_t i = band.offsets[of]; i < band.offsets[of + 1]; ++i) {
                const Piece& p = band.pieces[band.order[i]];
                add(p, p.share * share(p));
            }
        };
        if (k > 0) add_all(slice - 1, [](const Piece& p) { return p.nearer; });
        if (k + 1 < count_) add_all(slice, [](const Piece& p) { return 1 - p.nearer; });
    });
    return out;
}

}  // namespace postlens
