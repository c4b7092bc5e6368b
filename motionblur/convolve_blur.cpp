#include "motionblur/convolve_blur.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/threads.h"
#include "motionblur/depth_slices.h"
#include "motionblur/group_raster.h"
#include "motionblur/path_raster.h"
#include "reproject/fill_gaps.h"

namespace postlens {
namespace {

/// Coverage below this is the rounding of a Fourier transform.
constexpr float least_coverage = 2e-6F;

/// Sums over the point samples of one pixel, by how many groups are nearer than what stands still.
struct Between {
    std::array<double, 3> colour{};
    double covered = 0, known = 0;  ///< weight of samples that show something there, and of those that could
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
        parallel_for(bands_.size(), [&](std::size_t b) {
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

    // Light of which no surface behind is known gets the colours of the farthest that is known around.
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

    // The columns of a row that some group's window has.
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
        std::size_t filled = between.size();  // none
        bool any = false;
        for (std::uint32_t i = band.surfaces.offsets[sample]; i < band.surfaces.offsets[sample + 1]; ++i) {
            const Surface& s = band.surfaces.surfaces[i];
            const int g = table_(s.id);
            any = true;
            if (g >= 0) {
                known = std::max(known, static_cast<std::size_t>(g));
                continue;
            }
            // Groups that are nearer; depths_ falls.
            const auto rank = static_cast<std::size_t>(
                std::partition_point(depths_.begin(), depths_.end(),
                                     [&](double depth) { return depth > static_cast<double>(s.inverse_z); }) -
                depths_.begin());
            known = std::max(known, rank);
            if (rank == filled) continue;  // behind a nearer one
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
        double light = 1;  // what still comes through
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
        constexpr double least_light = 1e-4;  // what rounding leaves of coverage 1
        for (std::size_t c = 0; c < 3; ++c) out_.image.rgb[3 * p + c] = static_cast<float>(sum[c]);
        out_.touched[p] = 1;
        if (between.back().covered <= 0 && light > least_light) out_.unknown[p] = static_cast<float>(light);
    }

    const std::vector<BandSurfaces>& bands_;
    const GroupTable& table_;
    const std::vector<GroupPicture>&blurred_, &recorded_;
    const Image& still_;
    ConvolveBlur& out_;
    std::vector<double> depths_;  ///< of the groups, 1/m, falling
};

/// Blurs one group after the other: i1 * i2, in whole pixels.
class GroupBlur {
  public:
    GroupBlur(const Image& still, const Exposure& exposure, const ShutterCurve& curve, ConvolveBlur& out)
        : width_(still.width), height_(still.height), exposure_(exposure), curve_(curve), out_(out) {}

    [[nodiscard]] GroupPicture whole(const Planes& i1, const MovingGroup& group, int c) {
        return in_pixels(convolved(i1, group.path, {}, c), c, width_, height_);
    }

    /// Slices are parts of one opaque surface: they add up.
    [[nodiscard]] GroupPicture sliced(const DepthSlices& slices, const MovingGroup& group, int c) {
        GroupPicture out = frame_of(slices, group, c);
        std::vector<std::vector<double>> along;  // by axis and point of the path
        for (const PathAxis& axis : slices.axes()) {
            along.emplace_back();
            for (const PathPoint& p : group.path)
                along.back().push_back(std::max(0.0, glm::dot(p.at_px, axis.direction) - axis.low_px));
        }
        for (int k = 0; k < slices.count(); ++k) {
            const SliceRaster i1 = slices.draw(k);
            std::vector<PathPoint> path = group.path;
            for (PathPoint& p : path) p.at_px *= slices.path_scale(k);
            add(in_pixels(convolved(i1.flat, path, {}, c), c, width_, height_), out);
            for (std::size_t a = 0; a < i1.stretched.size(); ++a)
                add(in_pixels(convolved(i1.stretched[a], path, along[a], c), c, width_, height_), out);
        }
        // Where parts that differ in depth come to lie on each other, only one is seen. What is left of sums
        // that should be 0 is rounding.
        const float rounding = least_coverage * static_cast<float>(slices.count());
        for (auto& p : out.rgba) {
            if (p[3] <= rounding) p = {0, 0, 0, 0};
            const float scale = p[3] > 1 ? 1 / p[3] : 1;
            for (float& v : p) v = std::max(0.0F, v * scale);
        }
        return out;
    }

  private:
    [[nodiscard]] Planes convolved(const Planes& i1, const std::vector<PathPoint>& path,
                                   const std::vector<double>& values, int c) {
        // Displacements that bring some of it into the frame.
        const CellWindow frame{0, width_ * c, 0, height_ * c};
        const CellWindow reach{frame.x_begin - (i1.x_begin + i1.width), frame.x_end - i1.x_begin,
                               frame.y_begin - (i1.y_begin + i1.height), frame.y_end - i1.y_begin};
        const PathRaster i2 =
            draw_path(path, {0, 0}, exposure_.open_s, exposure_.close_s, curve_, c, reach, values);
        ConvolutionMethod used = ConvolutionMethod::automatic;
        Planes moved = convolve(i1, i2, ConvolutionMethod::automatic, &used, frame);
        (used == ConvolutionMethod::fft ? out_.fft_groups : out_.direct_groups) += 1;
        return moved;
    }

    /// Nothing, over the part of the frame that the group may pass over.
    [[nodiscard]] GroupPicture frame_of(const DepthSlices& slices, const MovingGroup& group, int c) const {
        glm::dvec2 low(0), high(0);
        for (const PathPoint& p : group.path) {
            for (const int k : {0, slices.count() - 1}) {
                low = glm::min(low, slices.path_scale(k) * p.at_px);
                high = glm::max(high, slices.path_scale(k) * p.at_px);
            }
        }
        const CellWindow& w = slices.window();
        const auto within = [](double px, int limit) {
            return static_cast<int>(std::clamp(px, 0.0, static_cast<double>(limit)));
        };
        // A cell reaches half beyond its middle.
        GroupPicture out;
        out.x_begin = within(std::floor(1.0 * w.x_begin / c + low.x) - 1, width_);
        out.x_end = std::max(out.x_begin, within(std::ceil(1.0 * w.x_end / c + high.x) + 1, width_));
        out.y_begin = within(std::floor(1.0 * w.y_begin / c + low.y) - 1, height_);
        out.y_end = std::max(out.y_begin, within(std::ceil(1.0 * w.y_end / c + high.y) + 1, height_));
        out.rgba.assign(static_cast<std::size_t>(out.x_end - out.x_begin) *
                            static_cast<std::size_t>(out.y_end - out.y_begin),
                        {0, 0, 0, 0});
        return out;
    }

    static void add(const GroupPicture& part, GroupPicture& to) {
        const auto columns = static_cast<std::size_t>(to.x_end - to.x_begin);
        const int y_begin = std::max(part.y_begin, to.y_begin), y_end = std::min(part.y_end, to.y_end);
        const int x_begin = std::max(part.x_begin, to.x_begin), x_end = std::min(part.x_end, to.x_end);
        for (int y = y_begin; y < y_end; ++y) {
            for (int x = x_begin; x < x_end; ++x) {
                auto& sum = to.rgba[static_cast<std::size_t>(y - to.y_begin) * columns +
                                    static_cast<std::size_t>(x - to.x_begin)];
                const auto& own = *part.at(x, y);
                for (std::size_t k = 0; k < 4; ++k) sum[k] += own[k];
            }
        }
    }

    int width_, height_;
    const Exposure& exposure_;
    const ShutterCurve& curve_;
    ConvolveBlur& out_;
};

}  // namespace

ConvolveBlur convolve_blur(const Image& still, const std::vector<BandSurfaces>& bands,
                           const std::vector<MovingGroup>& groups, const Exposure& exposure,
                           const ShutterCurve& curve, double across_per_px) {
    ConvolveBlur out;
    out.image = still;
    const GroupTable table(groups);
    GroupBlur blur(still, exposure, curve, out);
    std::vector<GroupPicture> blurred, recorded;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const MovingGroup& group = groups[g];
        const int c = cells_for(group);
        const Planes i1 = draw_group(bands, table, static_cast<int>(g), group, c);
        recorded.push_back(in_pixels(i1, c, still.width, still.height));
        blurred.push_back(group.has_parallax ? blur.sliced(DepthSlices(bands, table, static_cast<int>(g),
                                                                       group, c, across_per_px),
                                                           group, c)
                                             : blur.whole(i1, group, c));
    }
    Composite(bands, groups, table, blurred, recorded, still, out).run();
    return out;
}

}  // namespace postlens
