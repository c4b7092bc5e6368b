#include "reproject/patches/view_rays.h"

#include <optional>

namespace postlens {
namespace {

/// Returns the area, in px^2, that a view's pixel covers in the recorded pinhole image. `p` is the surface
/// point that the pixel shows. `motion` maps surface points from the recorded instant to the view's instant.
/// Returns nothing if `p` lies outside the recorded image.
std::optional<double> recorded_px2(const RasterMap& motion, const ShownView& shown, const RasterPoint& p) {
    const RasterMap moved = through_lens(motion, shown.view.lens);
    const auto at = RasterMap(glm::inverse(moved.matrix()), moved.projection()).tangent(p, {0, 0}, {0, 0});
    if (!at) return std::nullopt;
    const glm::ivec2 begin = shown.field.recorded_begin, end = shown.field.recorded_end;
    if (begin != end && !(at->at.x >= begin.x && at->at.x < end.x && at->at.y >= begin.y && at->at.y < end.y))
        return std::nullopt;
    return at->by_x.x * at->by_y.y - at->by_x.y * at->by_y.x;
}

/// Returns whether the records of instant `u` (0 or 1) determine which surface pixel `k` of the view shows
/// directly. They do not if an edge crosses the recorded quadtree cell, or if a nearer surface with an
/// unknown edge may cover the pixel.
bool sure(const ShownView& shown, std::size_t u, std::size_t k) {
    const std::uint32_t texel = shown.seen[u].texel[k];
    return texel != SeenTile::no_texel && !shown.seen[u].may_be_hidden(k) && !shown.mesh(u).unsure(texel);
}

}  // namespace

bool ShownView::has_vague_outline(std::size_t u, std::size_t k) const {
    const std::vector<RasterMap>&of_mine = view.uses[u].motions, &of_other = view.uses[1 - u].motions;
    const Texel& texel = mesh(u).sheets->texels[seen[u].texel[k]];
    if (of_mine.empty() || of_other.empty() || !texel.unsure()) return false;
    const Sheet& sheet = mesh(u).sheets->sheets[texel.sheet()];
    const std::size_t motion = field.motion_class(sheet.key.id);
    const int x = static_cast<int>(k % SeenTile::edge), y = static_cast<int>(k / SeenTile::edge);
    const RasterPoint p{at.x + x + view.sample.x, at.y + y + view.sample.y,
                        static_cast<double>(seen[u].inverse_z[k])};
    const auto mine = recorded_px2(of_mine[motion], *this, p);
    if (!mine || !(*mine < std::ldexp(1.0, -2 * sheet.depth))) return false;
    const auto other = recorded_px2(of_other[motion], *this, p);
    return other && *other > *mine;
}

void RaySamples::leave_to_rays(const ShownView& shown, int x, int y, double weight, LightSums& recorded) {
    const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
    if (!shown.passes(x, y)) {
        recorded[k][3] += weight;
        return;
    }
    shown.add_line(x, y, rays_.lines());
    rays_.finish(k, weight);
}

void RaySamples::find_doubtful(const ShownView& shown, bool parents) {
    if (!whole_tile() && shown.view.uses.size() == 1) {
        const std::uint32_t doubts =
            Texel::unsure_bit | Texel::unsure_below_bit | (parents ? Texel::children_bits : 0U);
        find_doubtful_pixels(shown.mesh(0).sheets->texels, shown.seen[0], shown.at.width, shown.at.height,
                             doubts, doubtful_);
        return;
    }
    doubtful_.count = 0;
    for (int y = 0; y < shown.at.height; ++y) {
        for (int x = 0; x < shown.at.width; ++x)
            doubtful_.pixels[doubtful_.count++] = static_cast<std::uint16_t>(y * SeenTile::edge + x);
    }
}

void RaySamples::set_aside(const ShownView& shown, LightSums& recorded) {
    const PatchView& v = shown.view;
    const bool moves = v.moves();
    const auto is_parent = [&](std::size_t u, std::size_t k) {
        const PatchMesh& mesh = shown.mesh(u);
        const std::uint32_t texel = shown.seen[u].texel[k];
        return (moves && mesh.sheets->texels[texel].children() != 0) ||
               (parents_too && mesh.drawn_children(texel) != 0);
    };
    fill_pixels(shown.at, uses, 0);
    find_doubtful(shown, moves || parents_too);
    for (const std::size_t k : doubtful_) {
        bool sure_of_all = !whole_tile();
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            sure_of_all = sure_of_all && sure(shown, u, k) && !is_parent(u, k);
        }
        if (sure_of_all && v.uses.size() == 2) sure_of_all = shown.id(0, k) == shown.id(1, k);
        if (sure_of_all) continue;
        leave_to_rays(shown, static_cast<int>(k % SeenTile::edge), static_cast<int>(k / SeenTile::edge),
                      v.weight, recorded);
        for (std::size_t u = 0; u < v.uses.size(); ++u) shown.seen[u].texel[k] = SeenTile::no_texel;
    }
}

void RaySamples::set_aside_trees(const ShownView& shown, std::size_t u, const TreeSums& trees,
                                 LightSums& recorded) {
    const PatchView& v = shown.view;
    const PatchMesh& mesh = shown.mesh(u);
    for (int y = 0; y < shown.at.height; ++y) {
        for (int x = 0; x < shown.at.width; ++x) {
            const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
            const std::uint32_t texel = shown.seen[u].texel[k];
            if (texel == SeenTile::no_texel || mesh.drawn_children(texel) == 0) continue;
            ++with_trees;
            if (trees.sure(k)) {
                ++with_sure_trees;
                continue;
            }
            if (v.uses.size() == 1) {
                leave_to_rays(shown, x, y, v.weight, recorded);
                shown.seen[u].texel[k] = SeenTile::no_texel;
                continue;
            }
            const double weight = v.weight * shown.share(u, k);
            if (weight > 0) leave_to_rays(shown, x, y, weight, recorded);
            uses[k] |= static_cast<std::uint8_t>(1U << u);
        }
    }
}

void RayBatch::trace(const PatchViews& set, LeftToRays left, LightSums& sums) {
    radiance_.resize(lines_.size());
    set.rays->trace(lines_, left == LeftToRays::samples_and_lights ? LightElsewhere{} : set.less, radiance_);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        auto& of = sums[pixel_[i]];
        for (std::size_t c = 0; c < 3; ++c) of[c] += weight_[i] * static_cast<double>(radiance_[i][c]);
        of[3] += weight_[i];
    }
    lines_.clear();
    pixel_.clear();
    weight_.clear();
}

void CheckedSamples::begin(const PatchField& field, const PatchViews& set, const TilePlace& at) {
    pixels_.resize(set.views.size());
    for (auto& of_view : pixels_) of_view.clear();
    sums.resize(SeenTile::pixels);
    fill_pixels(at, sums, {});
    for (int y = 0; y < at.height; ++y) {
        for (int x = 0; x < at.width; ++x) {
            views_.clear();
            set.checked(at.x - field.x + x, at.y - field.y + y, views_);
            const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
            sums[k].views = static_cast<std::uint32_t>(views_.size());
            for (const std::uint32_t view : views_) pixels_[view].push_back(static_cast<std::uint16_t>(k));
        }
    }
}

void CheckedSamples::note(const ShownView& shown, std::size_t number, std::size_t u, const RaySamples& rays,
                          const TreeSums* trees) {
    const std::vector<std::uint16_t>& pixels = pixels_[number];
    const std::size_t uses = shown.view.uses.size();
    if (u == 0) noted_.assign(pixels.size(), glm::dvec4(0));
    const PatchMesh& mesh = shown.mesh(u);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::size_t k = pixels[i];
        const std::uint32_t texel = shown.seen[u].texel[k];
        if (texel == SeenTile::no_texel || (rays.uses[k] >> u & 1U) != 0) continue;
        const double weight = uses == 1 ? 1 : shown.share(u, k);
        const glm::dvec3 light =
            glm::dvec3(mesh.light(texel)) + (trees != nullptr ? trees->light(k) : glm::dvec3(0));
        noted_[i] += weight * glm::dvec4(light, 1);
    }
    if (u + 1 < uses) return;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const int x = pixels[i] % SeenTile::edge, y = pixels[i] / SeenTile::edge;
        if (noted_[i].w == 0 || !shown.passes(x, y)) continue;
        shown.add_line(x, y, lines_);
        pixel_.push_back(pixels[i]);
        recorded_.push_back(noted_[i]);
    }
}

void CheckedSamples::check(const PatchViews& set) {
    radiance_.resize(lines_.size());
    set.rays->trace(lines_, set.less, radiance_);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        PixelCheck& of = sums[pixel_[i]];
        ++of.rays;
        for (std::size_t n = 0; n < 3; ++n) {
            of.sum[n] += static_cast<float>(recorded_[i].w * static_cast<double>(radiance_[i][n]) -
                                            recorded_[i][static_cast<int>(n)]);
        }
    }
    lines_.clear();
    pixel_.clear();
    recorded_.clear();
}

}  // namespace postlens
