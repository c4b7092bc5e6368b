#include "motionblur/groups/convolve_blur.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/progress.h"
#include "core/threads.h"
#include "motionblur/groups/group_blur.h"
#include "reproject/fill_gaps.h"

namespace postlens {
namespace {

/// Static surfaces in one interval of depth in a pixel. The groups of moving objects divide the depth range
/// into these intervals: the first interval lies in front of the nearest group, and the last one behind the
/// farthest group.
struct Between {
    /// Sum of the surfaces' colours over the samples of the pixel, weighted by the area that each sample
    /// represents.
    std::array<double, 3> colour{};
    /// Areas of the samples of the pixel. `covered` is the area of those that show a static surface in this
    /// interval. `known` is the area of those for which the file tells whether such a surface exists.
    double covered = 0, known = 0;
};

class Composite {
  public:
    Composite(const std::vector<BandSurfaces>& bands, const std::vector<MovingGroup>& groups,
              const GroupTable& table, const std::vector<GroupPicture>& blurred,
              const std::vector<GroupPicture>& recorded, const Image& still, ConvolveBlur& out)
        : bands_(bands), table_(table), blurred_(blurred), recorded_(recorded), still_(still), out_(out) {
        for (const MovingGroup& g : groups) depths_.push_back(g.inverse_z);
        const auto pixels =
            static_cast<std::size_t>(out.image.width) * static_cast<std::size_t>(out.image.height);
        out.touched.assign(pixels, 0);
        out.unknown.assign(pixels, 0);
    }

    void run() {
        for_each_touched([&](const BandSurfaces& band, int x, int y, std::vector<Between>& between) {
            composite(band, x, y, between);
        });
        if (std::any_of(out_.unknown.begin(), out_.unknown.end(), [](float u) { return u > 0; })) fill();
    }

  private:
    template <typename OnPixel>
    void for_each_touched(const OnPixel& on_pixel) const {
        Progress progress("shutter", bands_.size());
        parallel_for(bands_.size(), [&](std::size_t b) {
            progress.advance();
            std::vector<Between> between(depths_.size() + 1);
            const BandSurfaces& band = bands_[b];
            for (int y = std::max(0, band.y_begin); y < std::min(out_.image.height, band.y_end); ++y) {
                const auto [x_begin, x_end] = columns(y);
                for (int x = x_begin; x < x_end; ++x) {
                    if (is_touched(x, y)) on_pixel(band, x, y, between);
                }
            }
        });
    }

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(out_.image.width) +
               static_cast<std::size_t>(x);
    }

    // Fills the parts of the background that are not recorded. Their colours are interpolated from the
    // farthest static surfaces in the pixels around them.
    void fill() {
        Image farthest = still_;
        std::vector<float> known(out_.touched.size(), 1);
        for_each_touched([&](const BandSurfaces& band, int x, int y, std::vector<Between>& between) {
            add_up(band, x, y, between);
            const Between& last = between.back();
            const std::size_t p = index(x, y);
            known[p] = last.covered > 0 ? 1.0F : 0.0F;
            for (std::size_t c = 0; c < 3 && last.covered > 0; ++c)
                farthest.rgb[3 * p + c] = static_cast<float>(last.colour[c] / last.covered);
        });
        fill_gaps(farthest, known);
        for (std::size_t p = 0; p < known.size(); ++p) {
            for (std::size_t c = 0; c < 3; ++c)
                out_.image.rgb[3 * p + c] += out_.unknown[p] * farthest.rgb[3 * p + c];
        }
    }

    [[nodiscard]] std::pair<int, int> columns(int y) const {
        int begin = out_.image.width, end = 0;
        for (const auto* pictures : {&blurred_, &recorded_}) {
            for (const GroupPicture& p : *pictures) {
                if (y < p.y_begin || y >= p.y_end) continue;
                begin = std::min(begin, p.x_begin);
                end = std::max(end, p.x_end);
            }
        }
        return {begin, end};
    }

    [[nodiscard]] bool is_touched(int x, int y) const {
        for (std::size_t g = 0; g < blurred_.size(); ++g) {
            const auto *moved = blurred_[g].at(x, y), *still = recorded_[g].at(x, y);
            if ((moved != nullptr && (*moved)[3] > least_coverage) || (still != nullptr && (*still)[3] > 0))
                return true;
        }
        return false;
    }

    void add_sample(const BandSurfaces& band, std::uint32_t sample, double weight,
                    std::vector<Between>& between) const {
        std::size_t known = 0;
        std::size_t filled = between.size();
        bool any = false;
        for (std::uint32_t i = band.surfaces.offsets[sample]; i < band.surfaces.offsets[sample + 1]; ++i) {
            const LayerSurface& s = band.surfaces.surfaces[i];
            const int g = table_(s.id);
            any = true;
            if (g >= 0) {
                known = std::max(known, static_cast<std::size_t>(g));
                continue;
            }
            // `rank` is the number of groups of moving objects in front of the static surface s. `depths_`
            // holds the groups' inverse depths, sorted from near to far, so this number is found by a binary
            // search.
            const auto rank = static_cast<std::size_t>(
                std::partition_point(depths_.begin(), depths_.end(),
                                     [&](double depth) { return depth > static_cast<double>(s.inverse_z); }) -
                depths_.begin());
            known = std::max(known, rank);
            if (rank == filled) continue;  // a nearer static surface of the same interval hides this one
            filled = rank;
            Between& to = between[rank];
            to.colour[0] += weight * static_cast<double>(s.r);
            to.colour[1] += weight * static_cast<double>(s.g);
            to.colour[2] += weight * static_cast<double>(s.b);
            to.covered += weight;
        }
        if (!any) return;
        for (std::size_t j = 0; j <= known; ++j) between[j].known += weight;
    }

    void add_up(const BandSurfaces& band, int x, int y, std::vector<Between>& between) const {
        std::fill(between.begin(), between.end(), Between());
        band.for_each_leaf(x, y, [&](const Leaf& leaf) {
            const double weight = static_cast<double>(leaf.size) * static_cast<double>(leaf.size) / 4;
            for (const std::uint32_t corner : leaf.corner) add_sample(band, corner, weight, between);
        });
    }

    void composite(const BandSurfaces& band, int x, int y, std::vector<Between>& between) {
        add_up(band, x, y, between);
        const std::size_t p = index(x, y);
        std::array<double, 3> sum{};
        double light = 1;  // transmittance of the surfaces in front
        for (std::size_t j = 0; j < between.size(); ++j) {
            const Between& at = between[j];
            const bool last = j + 1 == between.size();
            if (at.covered > 0) {
                const double cover = last ? 1 : at.covered / at.known;
                for (std::size_t c = 0; c < 3; ++c) sum[c] += light * cover * at.colour[c] / at.covered;
                light *= 1 - cover;
            }
            if (last) break;
            if (const auto* group = blurred_[j].at(x, y); group != nullptr && (*group)[3] > least_coverage) {
                for (std::size_t c = 0; c < 3; ++c) sum[c] += light * static_cast<double>((*group)[c]);
                light *= std::max(0.0, 1 - static_cast<double>((*group)[3]));
            }
        }
        constexpr double least_light = 1e-4;  // rounding error of full coverage
        for (std::size_t c = 0; c < 3; ++c) out_.image.rgb[3 * p + c] = static_cast<float>(sum[c]);
        out_.touched[p] = 1;
        if (between.back().covered <= 0 && light > least_light) out_.unknown[p] = static_cast<float>(light);
    }

    const std::vector<BandSurfaces>& bands_;
    const GroupTable& table_;
    const std::vector<GroupPicture>&blurred_, &recorded_;
    const Image& still_;
    ConvolveBlur& out_;
    std::vector<double> depths_;  ///< inverse depths of the moving groups, 1/m, from near to far
};

/// Returns an upper bound of the error of compositing two groups of moving objects with their mean coverage
/// and mean light during the exposure. The error is a sum of squared errors over all pixels, for radiances up
/// to 1.
double covariance_bound(const GroupPicture& nearer, const GroupPicture& farther) {
    double sum = 0;
    for (int y = std::max(nearer.y_begin, farther.y_begin); y < std::min(nearer.y_end, farther.y_end); ++y) {
        for (int x = std::max(nearer.x_begin, farther.x_begin); x < std::min(nearer.x_end, farther.x_end);
             ++x) {
            // The error in this pixel is the covariance of the nearer group's coverage and the farther
            // group's light over time. Its square is at most the product of their variances.
            const double c = std::clamp(static_cast<double>((*nearer.at(x, y))[3]), 0.0, 1.0);
            // The nearer group's coverage lies between 0 and 1 and has the mean c, so its variance is at most
            // c (1 - c). The farther group's light lies between 0 and 1, so its variance is at most its mean,
            // which is at most the group's mean coverage.
            sum += c * (1 - c) * std::clamp(static_cast<double>((*farther.at(x, y))[3]), 0.0, 1.0);
        }
    }
    return sum;
}

std::vector<Crossing> crossings_of(const std::vector<GroupPicture>& blurred) {
    std::vector<Crossing> out(blurred.size());
    parallel_for(blurred.size(), [&](std::size_t g) {
        const auto touched =
            std::count_if(blurred[g].rgba.begin(), blurred[g].rgba.end(),
                          [](const std::array<float, 4>& pixel) { return pixel[3] > least_coverage; });
        for (std::size_t other = 0; other < blurred.size() && touched > 0; ++other) {
            if (other == g) continue;
            const double mse = covariance_bound(blurred[std::min(g, other)], blurred[std::max(g, other)]) /
                               static_cast<double>(touched);
            if (mse > out[g].most_mse) out[g] = {other, mse};
        }
    });
    return out;
}

}  // namespace

ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                           const std::vector<MovingGroup>& groups, const Exposure& exposure,
                           const ShutterCurve& curve, double across_per_px) {
    ConvolveBlur out;
    out.image = still;
    const GroupTable table(groups);
    std::vector<GroupPicture> blurred, recorded;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const MovingGroup& group = groups[g];
        const int c = cells_for(group);
        const Planes i1 = draw_group(bands, table, static_cast<int>(g), group, c);
        recorded.push_back(in_pixels(i1, c, still.width, still.height));
        GroupBlur blur(still.width, still.height, c, exposure, curve);
        if (group.has_parallax) {
            const DepthSlices slices(bands, table, static_cast<int>(g), group, c, across_per_px);
            blurred.push_back(blur.sliced(slices, group));
        } else {
            blurred.push_back(blur.whole(i1, group));
        }
    }
    out.crossings = crossings_of(blurred);
    Composite(bands, groups, table, blurred, recorded, still, out).run();
    return out;
}

}  // namespace postlens
