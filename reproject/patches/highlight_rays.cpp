#include "reproject/patches/highlight_rays.h"

#include <algorithm>

#include "core/sample_hash.h"
#include "reproject/patches/view_rays.h"

namespace postlens {
namespace {

/// Numbers of rays that measure the highlights' light in a pixel. First, `few_rays` test rays are traced. If
/// their radiances differ, the light is measured by `many_rays` further rays, and otherwise by `few_rays`
/// further ones. Including the test rays would bias the mean.
constexpr int few_rays = 4, many_rays = 28;
/// The radiances of a pixel's rays differ if, in some colour channel, greatest minus least exceeds this
/// fraction of the greatest.
constexpr double differing = 1e-3;

}  // namespace

bool CheckedHighlights::Aimed::rays_differ() const {
    for (std::size_t c = 0; c < 3; ++c) {
        if (most[c] - least[c] > differing * most[c]) return true;
    }
    return false;
}

void CheckedHighlights::check(const PatchField& field, const PatchViews& set, const TilePlace& at,
                              const std::vector<double>& light, std::vector<PixelCheck>& checks) {
    aimed_.clear();
    sums.resize(SeenTile::pixels);
    for (int y = 0; y < at.height; ++y) {
        for (int x = 0; x < at.width; ++x) {
            const auto k = static_cast<std::uint16_t>(y * SeenTile::edge + x);
            const double share = set.aimed ? set.aimed(at.x - field.x + x, at.y - field.y + y) : 0;
            sums[k] = {.aimed_share = static_cast<float>(share)};
            for (std::size_t c = 0; c < 3; ++c)
                sums[k].light[c] = static_cast<float>(light[Lights::values * k + c]);
            if (share > 0) aimed_.push_back({.pixel = k});
        }
    }
    if (aimed_.empty()) return;
    sources_ = set.lights->reaching(at.x - field.x, at.y - field.y, at.width, at.height);
    trace(field, set, at, Round::deciding, aimed_);
    agreeing_.clear();
    differing_.clear();
    for (const Aimed& a : aimed_) {
        checks[a.pixel].rays += a.rays;
        if (a.rays > 0) (a.rays_differ() ? differing_ : agreeing_).push_back({.pixel = a.pixel});
    }
    trace(field, set, at, Round::few, agreeing_);
    trace(field, set, at, Round::many, differing_);
    for (const std::vector<Aimed>* some : {&agreeing_, &differing_}) {
        for (const Aimed& a : *some) {
            sums[a.pixel].aimed = a.rays;
            for (std::size_t c = 0; c < 3; ++c) sums[a.pixel].aimed_sum[c] = static_cast<float>(a.sum[c]);
        }
    }
}

void CheckedHighlights::trace(const PatchField& field, const PatchViews& set, const TilePlace& at,
                              Round round, std::vector<Aimed>& aimed) {
    const int count = round == Round::many ? many_rays : few_rays;
    const PatchView& first = set.views.front();
    for (std::size_t i = 0; i < aimed.size(); ++i) {
        const int x = aimed[i].pixel % SeenTile::edge, y = aimed[i].pixel / SeenTile::edge;
        const auto column = static_cast<std::uint32_t>(at.x + x), row = static_cast<std::uint32_t>(at.y + y);
        // The rays of different pixels, views and rounds must be independent.
        std::uint64_t seed = mix64((std::uint64_t{row} << 32U) | column);
        seed = mix64(seed ^ ((std::uint64_t{first.set} << 32U) | first.number));
        seed = mix64(seed ^ static_cast<std::uint64_t>(round));
        aims_.clear();
        set.lights->aim(at.x - field.x + x, at.y - field.y + y, sources_, seed, count, aims_);
        for (std::size_t n = 0; n < aims_.size(); ++n) {
            SightLine line = aims_[n].line;
            line.x = at.x + x;
            line.y = at.y + y;
            line.set = first.set;
            line.view = static_cast<std::uint32_t>(n);
            lines_.push_back(line);
            highlights_.push_back(aims_[n].highlight);
            scales_.push_back(aims_[n].scale);
            aimed_of_line_.push_back(i);
        }
        if (lines_.size() >= lines_together) trace_lines(set, aimed);
    }
    trace_lines(set, aimed);
}

void CheckedHighlights::trace_lines(const PatchViews& set, std::vector<Aimed>& aimed) {
    if (lines_.empty()) return;
    radiance_.resize(lines_.size());
    set.rays->trace_elsewhere(lines_, highlights_, set.less, radiance_);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        Aimed& a = aimed[aimed_of_line_[i]];
        for (std::size_t c = 0; c < 3; ++c) {
            const double light = scales_[i] * static_cast<double>(radiance_[i][c]);
            a.sum[c] += light;
            a.least[c] = a.rays == 0 ? light : std::min(a.least[c], light);
            a.most[c] = a.rays == 0 ? light : std::max(a.most[c], light);
        }
        ++a.rays;
    }
    lines_.clear();
    highlights_.clear();
    scales_.clear();
    aimed_of_line_.clear();
}

}  // namespace postlens
