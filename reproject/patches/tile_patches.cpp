#include "reproject/patches/tile_patches.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/raster_rect.h"

namespace postlens {
namespace {

int tiles(int px) {
    return (px + SeenTile::edge - 1) / SeenTile::edge;
}

/// Sort key of a patch (part of a surface): first by its sequence of reflections and transmissions, then from
/// near to far.
std::uint64_t order_key(const PatchMesh& mesh, const Patch& patch) {
    // Converts the patch's inverse depth to an integer with the same order. The bits of positive floats
    // ascend with the value, but those of negative floats descend, so the latter are inverted. Adding 0 turns
    // -0 into +0.
    const auto bits = std::bit_cast<std::uint32_t>(mesh.planes[patch.first_plane].value + 0.0F);
    constexpr std::uint32_t sign = 0x80000000U;
    const std::uint32_t ascending = (bits & sign) != 0 ? ~bits : bits | sign;
    return std::uint64_t{mesh.sheet(patch).key.path.bits()} << 32U | std::uint32_t{~ascending};
}

}  // namespace

PatchBins::PatchBins(const PatchField& field, const MotionMarks& marks)
    : field_(field), columns_(tiles(field.width)), rows_(tiles(field.height)) {
    for (const PatchViews& set : field.sets) {
        for (const PatchView& v : set.views) {
            farthest_px_ = glm::max(farthest_px_, glm::abs(v.lens.lens_px));
            farthest_shift_px_ =
                std::max(farthest_shift_px_,
                         glm::length(v.lens.inverse_focus_per_m * v.lens.lens_px + v.lens.offset_px));
        }
    }
    farthest_px_ = glm::max(farthest_px_, field.lens_reach_px);
    const PatchSweep sweep(field);
    for (std::size_t i = 0; i < field.instants.size(); ++i) {
        const PatchMesh* deeper = field.instants[i].deeper;
        primary_.push_back(sorted(*field.instants[i].primary, i, marks, sweep));
        deeper_.push_back(deeper != nullptr ? sorted(*deeper, i, marks, sweep) : Bins());
        trees_ = trees_ || deeper != nullptr;
    }
}

PatchBins::Bins PatchBins::sorted(const PatchMesh& mesh, std::size_t instant, const MotionMarks& marks,
                                  const PatchSweep& sweep) const {
    std::vector<RasterRect> swept(mesh.patches.size());
    parallel_for(
        swept.size(),
        [&](std::size_t i) {
            const Patch& p = mesh.patches[i];
            swept[i] = sweep.of(mesh, p, instant);
            // If the object of a patch (planar part of a surface) moves, the patch also changes the pixels
            // where it was recorded, because it uncovers what is behind. Therefore, these pixels are added to
            // `swept`, the area in which the patch may appear.
            PatchPlace recorded;
            if (marks.any() && marks.of(instant, p.sheet) != 0 && place_patch(mesh, p, {}, {}, recorded))
                swept[i].add(covered(p, recorded));
        },
        256);
    Bins bins(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    const auto tile_of = [](double px, int first, int count) {
        return static_cast<int>(
            std::clamp(std::floor((px - first) / SeenTile::edge), -1.0, static_cast<double>(count)));
    };
    const auto pixel_of = [](double px, int first, int tile) {
        return static_cast<std::uint8_t>(
            std::clamp(std::floor(px - first - tile * SeenTile::edge), 0.0, SeenTile::edge - 1.0));
    };
    for (std::uint32_t i = 0; i < swept.size(); ++i) {
        const RasterRect& r = swept[i];
        if (!(r.x_min <= r.x_max && r.y_min <= r.y_max)) continue;
        const int x0 = std::max(0, tile_of(r.x_min - 1, field_.x, columns_)),
                  x1 = std::min(columns_ - 1, tile_of(r.x_max + 1, field_.x, columns_)),
                  y0 = std::max(0, tile_of(r.y_min - 1, field_.y, rows_)),
                  y1 = std::min(rows_ - 1, tile_of(r.y_max + 1, field_.y, rows_));
        for (int y = y0; y <= y1; ++y) {
            for (int x = x0; x <= x1; ++x) {
                Bin& bin = bins[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(x)];
                bin.patches.push_back(i);
                bin.pixels.push_back({pixel_of(r.x_min - 1, field_.x, x), pixel_of(r.x_max + 1, field_.x, x),
                                      pixel_of(r.y_min - 1, field_.y, y),
                                      pixel_of(r.y_max + 1, field_.y, y)});
            }
        }
    }
    parallel_for(bins.size(), [&](std::size_t t) {
        const Bin before = std::move(bins[t]);
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // key, index in the bin
        order.reserve(before.patches.size());
        for (std::uint32_t i = 0; i < before.patches.size(); ++i)
            order.emplace_back(order_key(mesh, mesh.patches[before.patches[i]]), i);
        std::sort(order.begin(), order.end());
        bins[t] = {};
        bins[t].patches.reserve(order.size());
        bins[t].pixels.reserve(order.size());
        for (const auto& [key, i] : order) {
            const NodePath path(static_cast<std::uint32_t>(key >> 32U));  // as order_key packs it
            std::vector<PatchChain>& chains = bins[t].chains;
            if (chains.empty() || chains.back().path != path)
                chains.push_back({path, bins[t].patches.size(), bins[t].patches.size()});
            ++chains.back().end;
            bins[t].patches.push_back(before.patches[i]);
            bins[t].pixels.push_back(before.pixels[i]);
        }
    });
    return bins;
}

void PatchBins::gather(std::size_t tile, const TilePart& rect, GatheredTile& out) const {
    out.primary.resize(field_.instants.size());
    out.deeper.resize(field_.instants.size());
    out.chains.assign(field_.instants.size(), {});
    out.paths.clear();
    for (std::size_t i = 0; i < field_.instants.size(); ++i) {
        const PatchMesh& mesh = *field_.instants[i].primary;
        const Bin& bin = primary_[i][tile];
        begin(mesh, out.primary[i]);
        for (std::size_t p = 0; p < bin.patches.size(); ++p) {
            if (bin.pixels[p].meet(rect)) add(mesh, bin.patches[p], out.primary[i]);
        }
    }
}

bool PatchBins::has_more_deeper(std::size_t tile, const TilePart& rect, std::size_t most) const {
    return std::any_of(deeper_.begin(), deeper_.end(), [&](const Bins& bins) {
        std::size_t count = 0;
        return !bins.empty() && bins[tile].pixels.size() > most &&
               std::any_of(bins[tile].pixels.begin(), bins[tile].pixels.end(),
                           [&](const Bin::Pixels& p) { return p.meet(rect) && ++count > most; });
    });
}

void PatchBins::gather_chains(std::size_t tile, const TilePart& rect, GatheredTile& out) const {
    for (std::size_t i = 0; i < field_.instants.size(); ++i) {
        if (field_.instants[i].deeper == nullptr) continue;
        const PatchMesh& mesh = *field_.instants[i].deeper;
        const Bin& bin = deeper_[i][tile];
        TilePatches& patches = out.deeper[i];
        begin(mesh, patches);
        for (const PatchChain& chain : bin.chains) {
            out.paths.push_back(chain.path);
            const std::size_t begin = patches.reach.size();
            for (std::size_t p = chain.begin; p < chain.end; ++p) {
                if (bin.pixels[p].meet(rect)) add(mesh, bin.patches[p], patches);
            }
            out.chains[i].push_back({chain.path, begin, patches.reach.size()});
        }
    }
    if (!out.paths.empty()) {
        out.paths.push_back(NodePath().child(NodePath::Bounce::reflected));
        out.paths.push_back(NodePath().child(NodePath::Bounce::transmitted));
    }
}

void PatchBins::begin(const PatchMesh& mesh, TilePatches& out) {
    out.mesh.sheets = mesh.sheets;
    out.mesh.overlap_px = mesh.overlap_px;
    out.mesh.patches.clear();
    out.mesh.planes.clear();
    out.reach.clear();
    out.motion_class.clear();
}

void PatchBins::add(const PatchMesh& mesh, std::uint32_t patch, TilePatches& out) const {
    Patch p = mesh.patches[patch];
    if (field_.motion_class)
        out.motion_class.push_back(static_cast<std::uint32_t>(motion_class_of(field_, mesh, p)));
    out.reach.push_back(patch_reach(mesh, p, farthest_px_, farthest_shift_px_));
    const auto planes = mesh.planes.begin() + p.first_plane;
    p.first_plane = static_cast<std::uint32_t>(out.mesh.planes.size());
    out.mesh.planes.insert(out.mesh.planes.end(), planes,
                           planes + static_cast<std::ptrdiff_t>(mesh.sheets->values));
    out.mesh.patches.push_back(p);
}

}  // namespace postlens
