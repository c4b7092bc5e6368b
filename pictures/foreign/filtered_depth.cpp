#include "pictures/foreign/filtered_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/threads.h"
#include "pictures/foreign/foreign_depths.h"

namespace postlens {
namespace {

/// Neighbouring pixels show the same surface if their depths differ by at most this relative amount.
constexpr double same = 0.05;
/// Smallest step in depth that counts as an edge, as a fraction of the nearer depth.
constexpr double least_step = 0.1;
/// A depth edge is detected only if the depths on both sides of it are nearly constant. On each side, the
/// depths of neighbouring pixels may differ by at most this fraction of the step, which is the difference
/// between the depths of the two sides.
constexpr double plateau = 0.1;
constexpr std::size_t longest_ramp = 4;  ///< px between two plateaus; for a filter of radius 2 px
constexpr std::size_t few = 4;           ///< fewer edges than this are not enough evidence
constexpr float transparent = 0.02F, opaque = 0.998F;

bool is_nothing(float v) {
    return !(std::abs(v) < ForeignDepths::nothing_z) || v == 0;
}

bool alike(float a, float b) {
    const auto x = static_cast<double>(a), y = static_cast<double>(b);
    return std::abs(x - y) <= same * std::max(std::abs(x), std::abs(y));
}

class Mender {
  public:
    Mender(std::span<float> depth, std::span<const float> alpha, std::size_t width)
        : depth_(depth), alpha_(alpha), width_(width), height_(width > 0 ? depth.size() / width : 0) {}

    FilteredDepths run(bool means) {
        FilteredDepths out;
        divide_by_alpha(out);
        if (means) find_ramps();
        if (ramps_ >= few && 2 * ramps_ >= jumps_) {
            for (const auto& [pixel, found] : found_) settle(found, out);
        }
        take_over_rims(out);
        return out;
    }

  private:
    [[nodiscard]] bool is_rim(std::size_t i) const { return alpha_[i] > transparent && alpha_[i] < opaque; }

    /// Calls visit(pixel) for every pixel whose row and column differ from those of pixel i by at most
    /// `reach`, but not for i.
    template <typename Visit>
    void around(std::size_t i, std::size_t reach, const Visit& visit) const {
        const std::size_t x = i % width_, y = i / width_;
        for (std::size_t v = y - std::min(y, reach); v <= std::min(y + reach, height_ - 1); ++v) {
            for (std::size_t u = x - std::min(x, reach); u <= std::min(x + reach, width_ - 1); ++u) {
                if (u != x || v != y) visit(v * width_ + u);
            }
        }
    }

    void divide_by_alpha(FilteredDepths& out) {
        std::size_t times = 0, plain = 0;
        for (std::size_t i = 0; i < depth_.size(); ++i) {
            if (!is_rim(i) || is_nothing(depth_[i])) continue;
            bool fits = false, fits_divided = false;
            around(i, 1, [&](std::size_t k) {
                if (alpha_[k] < opaque || is_nothing(depth_[k])) return;
                fits = fits || alike(depth_[k], depth_[i]);
                fits_divided = fits_divided || alike(depth_[k], depth_[i] / alpha_[i]);
            });
            if (fits != fits_divided) ++(fits ? plain : times);
        }
        if (times < few || times < 4 * plain) return;
        for (std::size_t i = 0; i < depth_.size(); ++i) {
            if (!(alpha_[i] > 0 && alpha_[i] < 1) || is_nothing(depth_[i])) continue;
            depth_[i] /= alpha_[i];
            ++out.divided;
        }
    }

    /// Depth edges found along rows or columns. A jump lies between two adjacent pixels. A ramp extends over
    /// several pixels, each with a mixture of two surfaces' depths.
    struct Edges {
        std::size_t jumps = 0, ramps = 0;
        std::vector<MixedDepth> mixed;
    };

    void find_ramps() {
        const auto look = [this](std::size_t lines, const auto& along) {
            constexpr std::size_t lines_of_task = 16;
            std::vector<Edges> found((lines + lines_of_task - 1) / lines_of_task);
            parallel_for(found.size(), [&](std::size_t task) {
                for (std::size_t i = task * lines_of_task; i < std::min(lines, (task + 1) * lines_of_task);
                     ++i)
                    along(i, found[task]);
            });
            for (const Edges& edges : found) {
                jumps_ += edges.jumps;
                ramps_ += edges.ramps;
                for (const MixedDepth& m : edges.mixed) keep(m);
            }
        };
        look(height_, [this](std::size_t y, Edges& out) { look_along(y * width_, 1, width_, out); });
        look(width_, [this](std::size_t x, Edges& out) { look_along(x, width_, height_, out); });
    }

    /// True if the neighbouring pixels with the depths a and b lie on the same side of a depth edge near
    /// them. Then a and b differ by at most the fraction `plateau` of `step`, the change of depth at this
    /// edge.
    [[nodiscard]] static bool is_plateau(double step, float a, float b) {
        // Two infinite depths are equal, but their difference is not a number.
        return a == b || std::abs(static_cast<double>(a) - static_cast<double>(b)) <= plateau * step;
    }

    /// True if the depths of two neighbouring pixels are almost equal: they differ by at most 1/60 of the
    /// nearer depth.
    [[nodiscard]] static bool is_even(float a, float b) {
        // A run of pixels with such small steps contains no depth edge. An edge has at most longest_ramp + 1
        // steps, over which the depth grows by a factor above 1 + least_step, but (1 + 1 / 60)^(longest_ramp
        // + 1) < 1 + least_step.
        constexpr double most = 1.0 / 60;
        const auto x = static_cast<double>(a), y = static_cast<double>(b);
        return std::abs(x - y) <= most * std::min(std::abs(x), std::abs(y));
    }

    void look_along(std::size_t first, std::size_t stride, std::size_t count, Edges& out) const {
        const auto at = [&](std::size_t i) { return depth_[first + i * stride]; };
        std::size_t even_end = 1;  // depths change little from `begin` to here
        for (std::size_t begin = 1; begin + 2 < count; ++begin) {
            // Skips the pixel `begin` if no depth edge can begin there. An edge from `begin` has at most
            // longest_ramp + 1 steps, so it ends at the pixel `last` or before. If the depth changes very
            // little in each of these steps, there is no edge.
            const std::size_t last = std::min(begin + longest_ramp + 1, count - 1);
            even_end = std::max(even_end, begin);
            while (even_end < last && is_even(at(even_end), at(even_end + 1))) ++even_end;
            if (even_end == last) continue;
            for (std::size_t length = 0; length <= longest_ramp && begin + length + 2 < count; ++length) {
                const std::size_t end = begin + length + 1;
                const float a = at(begin), b = at(end);
                if (!std::isfinite(a) || !std::isfinite(b)) break;
                const double step = std::abs(static_cast<double>(a) - static_cast<double>(b));
                const double nearer =
                    std::min(std::abs(static_cast<double>(a)), std::abs(static_cast<double>(b)));
                if (!(step > least_step * nearer) || !is_plateau(step, at(begin - 1), a)) continue;
                if (!is_plateau(step, b, at(end + 1))) continue;
                if (length > 0 && !leads_evenly(at, begin, end, plateau * step)) continue;
                ++(length > 0 ? out.ramps : out.jumps);
                // Estimates the depths of the two surfaces at a depth edge, `before` and `after`. The pixels
                // from `begin` to `end` may have mixed depths, because the program that wrote the file
                // filtered them. So each depth is extrapolated from the two nearest pixels outside this
                // range.
                const float before = goes_on(at(begin - 1), begin > 1 ? at(begin - 2) : at(begin - 1), step),
                            after = goes_on(at(end + 1), end + 2 < count ? at(end + 2) : at(end + 1), step);
                const auto is_empty = [&](std::size_t i) {
                    return is_nothing(at(i)) || alpha_[first + i * stride] <= transparent;
                };
                const bool empty = at(begin) < at(end) ? is_empty(end + 1) : is_empty(begin - 1);
                for (std::size_t i = begin; i <= end; ++i)
                    note(first + i * stride, at(i), before, after, empty, out);
                break;
            }
        }
    }

    /// Extrapolates the depth of a surface by one pixel, towards a depth edge, from the surface's last two
    /// pixels.
    [[nodiscard]] static float goes_on(float last, float before, double step) {
        return is_plateau(step, last, before) && std::isfinite(before) ? last + (last - before) : last;
    }

    template <typename At>
    [[nodiscard]] static bool leads_evenly(const At& at, std::size_t begin, std::size_t end, double least) {
        const double up = at(end) > at(begin) ? 1 : -1;
        const auto height = [&](std::size_t i) { return up * static_cast<double>(at(i)); };
        // A run of pixels is not a ramp (a filtered depth edge) if the depth changes very little in its first
        // or last step, because the pixel at this end then shows only one surface. `least` is the largest
        // difference between depths that count as equal at this edge.
        if (height(begin + 1) - height(begin) < 0.2 * least || height(end) - height(end - 1) < 0.2 * least)
            return false;
        for (std::size_t i = begin; i < end; ++i) {
            if (!(height(i + 1) > height(i))) return false;
        }
        return true;
    }

    void note(std::size_t pixel, float v, float a, float b, bool far_is_empty, Edges& out) const {
        const auto size = [](float x) { return is_nothing(x) ? ForeignDepths::nothing_z : std::abs(x); };
        MixedDepth m{pixel, a, b, 0, far_is_empty};
        if (size(m.near) > size(m.far)) std::swap(m.near, m.far);
        m.before_nothing = m.before_nothing || is_nothing(m.far);
        m.near_share = std::clamp((v - m.far) / (m.near - m.far), 0.0F, 1.0F);
        constexpr float hardly = 5e-4F;
        if (m.near_share > 1 - hardly || (m.near_share < hardly && alpha_[pixel] >= opaque)) return;
        out.mixed.push_back(m);
    }

    void keep(const MixedDepth& m) {
        const auto [it, is_new] = found_.try_emplace(m.pixel, m);
        // A pixel at a depth edge may be found twice, because edges are searched along rows and along
        // columns. The result in which the two surfaces' depths differ more is kept. The other search may run
        // parallel to the edge, where the neighbours' depths are mixed as well.
        const auto step = [](const MixedDepth& x) { return std::abs(x.near - x.far); };
        if (!is_new && step(m) > step(it->second)) it->second = m;
    }

    void settle(const MixedDepth& m, FilteredDepths& out) {
        if (alpha_[m.pixel] < opaque && m.before_nothing) {
            depth_[m.pixel] = m.near;
            ++out.taken_over;
            return;
        }
        depth_[m.pixel] = m.near_share >= 0.5F ? m.near : m.far;
        out.mixed.push_back(m);
    }

    /// Repairs pixels at the silhouette of an object in front of empty space. Empty space has an infinite
    /// depth. So when the other program filtered the depths, the depth of these pixels became infinite. Each
    /// of them gets the depth of the nearest opaque surface within 2 px.
    void take_over_rims(FilteredDepths& out) {
        std::vector<std::pair<std::size_t, float>> rims;
        for (std::size_t i = 0; i < depth_.size(); ++i) {
            if (!(alpha_[i] > 0 && alpha_[i] < opaque) || !is_nothing(depth_[i])) continue;
            bool before_nothing = false;
            float nearest = 0;
            // The radius of the filter is 2 px.
            around(i, 2, [&](std::size_t k) {
                before_nothing = before_nothing || alpha_[k] <= transparent;
                if (alpha_[k] >= opaque && !is_nothing(depth_[k]) &&
                    (nearest == 0 || std::abs(depth_[k]) < std::abs(nearest)))
                    nearest = depth_[k];
            });
            if (before_nothing && nearest != 0) rims.emplace_back(i, nearest);
        }
        for (const auto& [pixel, v] : rims) depth_[pixel] = v;
        out.taken_over += rims.size();
    }

    std::span<float> depth_;
    std::span<const float> alpha_;
    std::size_t width_, height_;
    std::size_t jumps_ = 0, ramps_ = 0;
    std::map<std::size_t, MixedDepth> found_;
};

}  // namespace

FilteredDepths mend_filtered_depths(std::span<float> depth, std::span<const float> alpha, std::size_t width,
                                    bool means) {
    return Mender(depth, alpha, width).run(means);
}

}  // namespace postlens
