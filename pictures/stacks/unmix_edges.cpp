#include "pictures/stacks/unmix_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "core/memory.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// The colour of each surface in a pixel at an edge is taken from pixels that show only this surface. They
/// are searched up to these distances, in px. `reach_of_means_px` is for depths that another program has
/// filtered, because then more pixels around the edge are mixed.
constexpr int reach_px = 2, reach_of_means_px = 5;
/// Depths of nearby pixels count as those of one surface if they differ by at most this fraction.
constexpr double same_surface = 0.05;

/// Converts a value to float, and clamps it to the range of float. This is needed because the computed colour
/// of a surface that covers only a part of a very bright pixel may exceed this range.
float within_float(double value) {
    constexpr double most = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(value, -most, most));
}

/// One surface in a pixel that shows several surfaces. `share` is the fraction of the pixel that it covers.
/// `rgba` is the colour and alpha that the pixel would have if it showed only this surface. The colour is
/// premultiplied by alpha.
struct Portion {
    std::uint32_t id = 0;
    double share = 0;
    std::optional<double> at;  ///< inverse depth, 1/m; set if depths, not ids, identify the surface
    std::array<double, 4> rgba{};
    double inverse_z = 0;
    bool has_colour = false, has_depth = false;
    /// True if this part of the pixel shows no surface, but empty space. The part's colour and alpha, `rgba`,
    /// are those of nearby pixels that show only what this part shows. If these pixels are empty, all four
    /// values are 0.
    [[nodiscard]] bool is_nothing() const {
        return has_colour && std::all_of(rgba.begin(), rgba.end(), [](double v) { return v == 0; });
    }
};

class Unmixer {
  public:
    explicit Unmixer(const ForeignPicture& picture)
        : p_(picture), width_(picture.x_end - picture.x_begin), mixed_(picture.offsets.size() - 1) {
        for (const MixedPixel& m : p_.mixed) mixed_[m.pixel] = 1;
    }

    /// Divides a pixel that shows several surfaces: returns samples, one for each surface, which replace the
    /// pixel's sample. Returns no samples if fewer than two of the surfaces are found in nearby pixels. Then,
    /// the pixel remains unchanged.
    [[nodiscard]] std::vector<StackSample> apart(const MixedPixel& m) const {
        std::vector<Portion> portions;
        for (std::size_t i = m.first; i < m.first + m.count; ++i) {
            const SurfaceShare& s = p_.shares[i];
            Portion portion;
            portion.id = s.id;
            portion.share = static_cast<double>(s.share);
            if (s.inverse_z) portion.at = static_cast<double>(*s.inverse_z);
            find(m.pixel, portion);
            if (portion.has_depth) portions.push_back(portion);
        }
        if (portions.size() < 2) return {};
        double sum = 0;
        for (const Portion& portion : portions) sum += portion.share;
        for (Portion& portion : portions) portion.share /= sum;
        const std::array<double, 4> whole = value_of(m.pixel);
        give_colours(whole, {portions.begin(), std::stable_partition(portions.begin(), portions.end(),
                                                                     [](const Portion& portion) {
                                                                         return !portion.is_nothing();
                                                                     })});
        return stack_of(whole[3], portions);
    }

  private:
    [[nodiscard]] std::array<double, 4> value_of(std::size_t pixel) const {
        if (is_empty(pixel)) return {};
        const StackSample& s = p_.samples[p_.offsets[pixel]];
        return {static_cast<double>(s.r), static_cast<double>(s.g), static_cast<double>(s.b),
                static_cast<double>(s.alpha)};
    }
    [[nodiscard]] std::uint32_t id_of(std::size_t pixel) const {
        return is_empty(pixel) ? 0 : p_.samples[p_.offsets[pixel]].id;
    }
    [[nodiscard]] double inverse_z_of(std::size_t pixel) const {
        return is_empty(pixel) ? 0 : static_cast<double>(p_.samples[p_.offsets[pixel]].inverse_z);
    }

    /// Calls visit(index, squared distance) for all pixels at most `reach` px from `pixel` in x and in y. The
    /// file need not store empty pixels of the image. For such a pixel, the index is `unstored`.
    template <typename Visit>
    void around(std::size_t pixel, int reach, const Visit& visit) const {
        const auto width = static_cast<std::size_t>(width_);
        const int x = p_.x_begin + static_cast<int>(pixel % width),
                  y = p_.y_begin + static_cast<int>(pixel / width);
        for (int v = y - reach; v <= y + reach; ++v) {
            for (int u = x - reach; u <= x + reach; ++u) {
                const bool stored = p_.stores(u, v);
                if (!stored && (u < 0 || u >= p_.width || v < 0 || v >= p_.height)) continue;
                visit(stored ? static_cast<std::size_t>(v - p_.y_begin) * width +
                                   static_cast<std::size_t>(u - p_.x_begin)
                             : unstored,
                      (u - x) * (u - x) + (v - y) * (v - y));
            }
        }
    }
    static constexpr std::size_t unstored = ~std::size_t{0};

    [[nodiscard]] bool is_empty(std::size_t pixel) const {
        return pixel == unstored || p_.offsets[pixel] == p_.offsets[pixel + 1];
    }
    [[nodiscard]] bool is_mixed(std::size_t pixel) const { return pixel != unstored && mixed_[pixel] != 0; }
    [[nodiscard]] static bool alike(double a, double b) {
        return std::abs(a - b) <= same_surface * std::max(a, b);
    }

    void find(std::size_t pixel, Portion& portion) const {
        const int reach = portion.at ? reach_of_means_px : reach_px;
        for (const bool pure : {true, false}) {
            int nearest = 0;
            double depth = 0;
            const auto is_one = [&](std::size_t at) {
                if (is_mixed(at) == pure) return false;
                return portion.at ? alike(inverse_z_of(at), *portion.at) : id_of(at) == portion.id;
            };
            around(pixel, reach, [&](std::size_t at, int distance) {
                if (!is_one(at) || (portion.has_depth && distance >= nearest)) return;
                nearest = distance;
                depth = inverse_z_of(at);
                if (portion.at) portion.id = id_of(at);
                portion.has_depth = true;
            });
            if (!portion.has_depth) continue;
            // Averages the colours and depths of the nearby pixels that show the surface of `portion`, with
            // the weight 1 / squared distance. If no nearby pixel shows only this surface, mixed pixels are
            // averaged instead (`pure` is false).
            double sum = 0, depths = 0;
            around(pixel, reach, [&](std::size_t at, int distance) {
                const double z = inverse_z_of(at);
                if (!is_one(at) || !alike(z, depth)) return;
                // One of the mixed pixels may be this pixel itself, at the distance 0. So 0.5 is added to
                // avoid a division by 0.
                const double weight = 1 / (distance + (pure ? 0.0 : 0.5));
                const auto value = value_of(at);
                for (std::size_t c = 0; c < 4; ++c) portion.rgba[c] += weight * value[c];
                depths += weight * z;
                sum += weight;
            });
            for (double& channel : portion.rgba) channel /= sum;
            portion.inverse_z = depths / sum;
            portion.has_colour = pure;
            return;
        }
    }

    /// Adjusts the colours of the surfaces in a pixel, so that their mean, weighted by coverage, is the
    /// pixel's own colour, `whole`. If some of the surfaces are not shown alone by any nearby pixel, only the
    /// colours of these surfaces are changed.
    static void give_colours(const std::array<double, 4>& whole, std::span<Portion> portions) {
        double unknown = 0, squares = 0;
        for (const Portion& portion : portions) {
            if (!portion.has_colour) unknown += portion.share;
            squares += portion.share * portion.share;
        }
        for (std::size_t c = 0; c < 4; ++c) {
            double known = 0;
            for (const Portion& portion : portions) {
                if (portion.has_colour) known += portion.share * portion.rgba[c];
            }
            if (unknown > 0) {
                for (Portion& portion : portions) {
                    if (!portion.has_colour) portion.rgba[c] = (whole[c] - known) / unknown;
                }
            } else {
                for (Portion& portion : portions)
                    portion.rgba[c] += (whole[c] - known) * portion.share / squares;
            }
            if (whole[c] >= 0) keep_within(whole[c], c, portions);
        }
    }

    /// Limits the values of channel `c` of the surfaces in one pixel: a colour must be at least 0, and an
    /// alpha (c = 3) between 0 and 1. Then changes the values so that their mean, weighted by coverage, is
    /// again the pixel's own value, `whole`.
    static void keep_within(double whole, std::size_t c, std::span<Portion> portions) {
        const double most = c == 3 ? 1 : std::numeric_limits<double>::infinity();
        double sum = 0, room = 0;
        for (Portion& portion : portions) {
            portion.rgba[c] = std::clamp(portion.rgba[c], 0.0, most);
            sum += portion.share * portion.rgba[c];
            room += portion.share * (1 - portion.rgba[c]);
        }
        for (Portion& portion : portions) {
            double& value = portion.rgba[c];
            // If the mean of the alphas is too small, they are moved towards 1, so that none exceeds 1.
            if (c == 3 && whole > sum) {
                if (room > 0) value = std::min(1.0, value + (1 - value) * (whole - sum) / room);
            } else if (sum > 0) {
                value *= whole / sum;
            }
        }
    }

    /// Converts the surfaces of a pixel to a stack of samples that composites to the same colour and alpha. A
    /// sample receives only the light `left` that the nearer samples transmit. So the fraction of the pixel
    /// that a surface covers is divided by `left`.
    static std::vector<StackSample> stack_of(double whole_alpha, std::vector<Portion>& portions) {
        std::stable_sort(portions.begin(), portions.end(),
                         [](const Portion& a, const Portion& b) { return a.inverse_z > b.inverse_z; });
        std::vector<StackSample> out;
        double left = 1;
        constexpr double nothing_left = 1e-5;
        for (const Portion& portion : portions) {
            if (left <= nothing_left) break;
            const double times = portion.share / left;
            StackSample s;
            s.inverse_z = static_cast<float>(portion.inverse_z);
            s.id = portion.id;
            s.r = within_float(times * portion.rgba[0]);
            s.g = within_float(times * portion.rgba[1]);
            s.b = within_float(times * portion.rgba[2]);
            s.alpha = static_cast<float>(std::clamp(times * portion.rgba[3], 0.0, 1.0));
            if (1 - s.alpha < static_cast<float>(nothing_left)) s.alpha = 1;
            left -= portion.share * portion.rgba[3];
            if (s.alpha > 0 || s.r != 0 || s.g != 0 || s.b != 0) out.push_back(s);
        }
        // An opaque pixel must stay opaque, although the fractions are rounded.
        if (!out.empty() && whole_alpha == 1) out.back().alpha = 1;
        return out;
    }

    const ForeignPicture& p_;
    int width_;
    std::vector<std::uint8_t> mixed_;
};

}  // namespace

std::size_t unmix_edges(ForeignPicture& picture) {
    if (picture.mixed.empty()) return 0;
    const std::size_t pixels = picture.offsets.size() - 1;
    require_memory(picture.mixed.size() * sizeof(std::vector<StackSample>) +
                       picture.shares.size() * sizeof(StackSample) + pixels,
                   "edges taken apart");
    std::vector<std::vector<StackSample>> stacks(picture.mixed.size());
    {
        const Unmixer unmixer(picture);
        parallel_for(
            stacks.size(), [&](std::size_t i) { stacks[i] = unmixer.apart(picture.mixed[i]); }, 64);
    }
    std::size_t count = 0, more = 0;
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        if (stacks[i].empty()) continue;
        ++count;
        // A mixed pixel has at most one sample.
        more += stacks[i].size() - picture.stack_of(picture.mixed[i].pixel).size();
    }
    std::vector<StackSample>& samples = picture.samples;
    std::vector<std::uint64_t>& offsets = picture.offsets;
    std::size_t end = samples.size(), to = end + more;
    if (samples.capacity() < to) require_memory(to * sizeof(StackSample), "edges taken apart");
    samples.reserve(to);
    samples.resize(to);
    // Replaces the sample of each pixel that shows several surfaces by one sample per surface. Goes from last
    // to first pixel, so that no sample is overwritten before it is moved.
    const auto at = [&](std::size_t i) { return samples.begin() + static_cast<std::ptrdiff_t>(i); };
    for (std::size_t i = stacks.size(), last = pixels; i-- > 0;) {
        if (stacks[i].empty()) continue;
        const std::size_t pixel = picture.mixed[i].pixel, begin = offsets[pixel];
        const std::size_t behind = end - offsets[pixel + 1], by = to - end;
        if (by > 0) std::move_backward(at(end - behind), at(end), at(to));
        for (; last > pixel; --last) offsets[last] += by;
        to -= behind + stacks[i].size();
        std::copy(stacks[i].begin(), stacks[i].end(), at(to));
        end = begin;
    }
    picture.mixed.clear();
    picture.shares.clear();
    return count;
}

}  // namespace postlens
