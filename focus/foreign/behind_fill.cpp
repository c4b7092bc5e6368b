#include "focus/foreign/behind_fill.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/memory.h"
#include "core/threads.h"
#include "focus/responses/depth_levels.h"
#include "lens/aperture_response.h"

namespace postlens {
namespace {

/// Smallest difference, in px, between the signed CoC radii of two neighbouring samples on different
/// surfaces. The signed radius is negative in front of the focus, positive behind it, and grows with the
/// depth. If the radii differ by less than this, the samples count as one surface.
constexpr float least_step_px = 1;
/// The surface that is hidden behind a pixel is estimated from farther surfaces in its surroundings. This is
/// the largest distance of the search for them, in px.
constexpr float farthest_px = 512;
constexpr std::uint8_t many_steps = 255;

/// Two CoC radii of a sample, in px, negative in front of the focus. They are infinite for empty space.
/// - `own`: radius for the true depth
/// - `blur`: radius of the blur, which an effect such as "keep this object sharp" may change
struct Radii {
    float own = std::numeric_limits<float>::infinity();
    float blur = std::numeric_limits<float>::infinity();
    [[nodiscard]] bool is_nothing() const { return std::isinf(own); }
};

/// Returns whether the sample with the CoC radii `other` lies behind the sample with the radii `own`. A
/// signed CoC radius grows with the depth, so the farther sample has the larger one. Samples whose radii are
/// almost equal count as one surface.
bool is_farther(const Radii& other, const Radii& own) {
    // An effect, such as keeping an object sharp, may give almost equally deep samples different blur radii.
    // They then count as two surfaces.
    return other.own - own.own >= least_step_px ||
           (other.own > own.own && std::abs(other.blur - own.blur) >= least_step_px);
}

/// Returns whether `is` returns true for any sample.
template <typename Is>
bool any_sample(const ForeignPicture& picture, const Is& is) {
    std::atomic<bool> found = false;
    constexpr std::size_t samples_per_task = std::size_t{1} << 16;
    parallel_chunks(picture.samples.size(), samples_per_task, [&](std::size_t begin, std::size_t end) {
        const auto samples = std::span(picture.samples).subspan(begin, end - begin);
        if (!found && std::any_of(samples.begin(), samples.end(), is)) found = true;
    });
    return found;
}

}  // namespace

FocusGeometry around_aperture(const FocusGeometry& geometry, const Aperture& aperture) {
    FocusGeometry out = geometry;
    out.aperture_radius_m *= rim_of(aperture);
    return out;
}

class BehindSearch::Impl {
  public:
    Impl(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px)
        : p_(picture),
          geometry_(geometry),
          aberration_px_(static_cast<float>(aberration_px)),
          width_(picture.x_end - picture.x_begin),
          height_(picture.y_end - picture.y_begin),
          has_ids_(any_sample(picture, [](const StackSample& s) { return s.id != 0; })),
          last_px_(pixels()),
          blur_px_(any_sample(picture, [](const StackSample& s) { return s.moved_inverse_z >= 0; }) ? pixels()
                                                                                                    : 0),
          opaque_(pixels()) {
        std::vector<float> widest_px(static_cast<std::size_t>(height_), 0.0F);  // of each row
        parallel_for(static_cast<std::size_t>(height_), [&](std::size_t y) {
            for (std::size_t i = y * static_cast<std::size_t>(width_);
                 i < (y + 1) * static_cast<std::size_t>(width_); ++i) {
                const auto stack = p_.stack_of(i);
                double left = 1;
                for (const StackSample& s : stack) left *= 1 - static_cast<double>(s.alpha);
                const bool ends = p_.is_nothing_behind(i);
                opaque_[i] = left <= opaque_transmittance && !ends ? 1 : 0;
                const Radii last = stack.empty() || ends ? Radii() : radii_px(stack.back());
                set_last(i, last);
                if (std::isfinite(last.blur)) widest_px[y] = std::max(widest_px[y], std::abs(last.blur));
            }
        });
        for (const float r : widest_px) widest_px_ = std::max(widest_px_, r);
        find_translucent();
        parallel_for(directions.size(),
                     [&](std::size_t d) { find_steps(directions[d], steps_to_farther_[d]); });
    }

    [[nodiscard]] std::size_t pixels() const {
        return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int y_begin() const { return p_.y_begin; }

    [[nodiscard]] Behind behind(int x, int y) const {
        Behind out = guess(x, y);
        out.fills = fills_[index(x, y)] != 0;
        return out;
    }

  private:
    /// Decides which translucent pixels count as opaque. What lies behind a translucent pixel is estimated
    /// from farther surfaces in its neighbourhood. If there is no such surface close enough, the pixel counts
    /// as opaque, and is marked in `fills_`.
    void find_translucent() {
        fills_.assign(pixels(), 0);
        parallel_for(static_cast<std::size_t>(height_), [&](std::size_t y) {
            for (int x = 0; x < width_; ++x) {
                const std::size_t i = index(x, static_cast<int>(y));
                const Radii last = last_of(i);
                if (last.is_nothing() || (opaque_[i] != 0 && p_.stack_of(i).size() == 1) ||
                    transmittance_behind(p_.stack_of(i), p_.is_nothing_behind(i)) <= opaque_transmittance)
                    continue;
                fills_[i] = std::none_of(directions.begin(), directions.end(), [&](const Direction& d) {
                    return sees_farther(x, static_cast<int>(y), d, last);
                });
            }
        });
        constexpr std::size_t pixels_of_task = std::size_t{1} << 16;
        parallel_for(
            pixels(),
            [&](std::size_t i) {
                if (fills_[i] != 0) opaque_[i] = 1;
                if (opaque_[i] == 0) set_last(i, {});
            },
            pixels_of_task);
    }

    [[nodiscard]] Behind guess(int x, int y) const {
        const std::size_t here = index(x, y);
        if (opaque_[here] == 0 || !is_near_an_edge(here)) return {};
        std::array<Find, directions.size()> finds{};
        std::size_t count = 0;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            if (const Find f = look(x, y, d, last_of(here)); f.distance_px > 0) finds[count++] = f;
        }
        if (count == 0) return {};
        if (has_ids_) count = keep_most_seen(finds, count);
        // Estimates the hidden surface of the pixel (x, y) from `finds`, farther surfaces around the pixel.
        // The hidden surface gets the depth and object of `nearest`, the surface that was found closest to
        // the pixel. Its colour is the weighted mean of all found surfaces that have nearly this depth.
        const Find* nearest =
            std::min_element(finds.data(), finds.data() + count,
                             [](const Find& a, const Find& b) { return a.distance_px < b.distance_px; });
        std::array<double, 6> sum{};
        for (std::size_t i = 0; i < count; ++i) {
            if (is_farther(finds[i].radii, nearest->radii) || is_farther(nearest->radii, finds[i].radii))
                continue;
            const double weight = weight_of(finds[i]);
            const std::array<double, 4> colour = flattened(finds[i]);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * colour[c];
            sum[4] += weight * (finds[i].fills ? 1 : colour[3]);
            sum[5] += weight;
        }
        Behind out;
        out.known = true;
        if (!nearest->stack.empty()) {
            const StackSample& first = nearest->stack[0];
            out.inverse_z = first.inverse_z;
            out.spread_inverse_z = first.spread_inverse_z();
            out.id = first.id;
            out.holdout = first.holdout;
        }
        out.r = static_cast<float>(sum[0] / sum[5]);
        out.g = static_cast<float>(sum[1] / sum[5]);
        out.b = static_cast<float>(sum[2] / sum[5]);
        out.alpha = static_cast<float>(sum[3] / sum[5]);
        out.weight = static_cast<float>(sum[4] / sum[5]);
        return out;
    }

    struct Direction {
        int dx, dy;
    };
    static constexpr std::array<Direction, 8> directions{
        {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}};
    struct Find {
        float distance_px = 0;  ///< 0: none
        Radii radii;
        std::span<const StackSample> stack;  ///< samples from the first farther one on; empty for empty space
        bool fills = false;                  ///< as Behind::fills
    };

    /// Walks from the pixel (x, y), whose blur radius is `blur_px`, in the direction `d`, and calls `take`
    /// for each pixel on the way. The walk ends if `take` returns true, or beyond the image and its stored
    /// pixels.
    template <typename Take>
    void walk(int x, int y, const Direction& d, float blur_px, const Take& take) const {
        const float step_px = d.dx != 0 && d.dy != 0 ? 1.41421356F : 1;
        // Beyond this distance, no pixel's blur can overlap the blur of (x, y), so the walk ends.
        const float limit_px = limit_of(blur_px);
        for (int s = 1; static_cast<float>(s) * step_px <= limit_px; ++s) {
            x += d.dx;
            y += d.dy;
            if (!is_stored(x, y) && !in_raster(x, y)) return;
            if (take(static_cast<float>(s) * step_px, x, y)) return;
        }
    }
    /// Returns whether the blurs of two samples can cover the same pixels: their circles of confusion
    /// overlap, or lie at most one pixel apart. `a` and `b` have the radii of these circles, and
    /// `distance_px` is the distance between their centres.
    [[nodiscard]] bool reach_each_other(float distance_px, const Radii& a, const Radii& b) const {
        const float other = b.is_nothing() ? 0 : std::abs(b.blur) + aberration_px_;
        return distance_px <= std::abs(a.blur) + aberration_px_ + other + 1;
    }
    [[nodiscard]] float limit_of(float blur_px) const {
        return std::min(farthest_px, std::abs(blur_px) + widest_px_ + 2 * aberration_px_ + 1);
    }

    [[nodiscard]] bool sees_farther(int x, int y, const Direction& d, const Radii& own) const {
        bool found = false;
        Radii before = own;
        walk(x, y, d, own.blur, [&](float distance_px, int u, int v) {
            const Radii last = last_at(u, v);
            if (last.is_nothing()) return false;
            found =
                is_farther(last, before) && is_farther(last, own) && reach_each_other(distance_px, own, last);
            before = last;
            return found;
        });
        return found;
    }

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    // Whether the file stores this pixel. x and y are relative to its first stored pixel.
    [[nodiscard]] bool is_stored(int x, int y) const { return x >= 0 && x < width_ && y >= 0 && y < height_; }
    [[nodiscard]] Radii last_of(std::size_t i) const {
        return {last_px_[i], blur_px_.empty() ? last_px_[i] : blur_px_[i]};
    }
    [[nodiscard]] Radii last_at(int x, int y) const {
        return is_stored(x, y) ? last_of(index(x, y)) : Radii{};
    }
    void set_last(std::size_t i, const Radii& last) {
        last_px_[i] = last.own;
        if (!blur_px_.empty()) blur_px_[i] = last.blur;
    }
    [[nodiscard]] bool in_raster(int x, int y) const {
        return x + p_.x_begin >= 0 && x + p_.x_begin < p_.width && y + p_.y_begin >= 0 &&
               y + p_.y_begin < p_.height;
    }
    [[nodiscard]] float radius_px(float inverse_z) const {
        return static_cast<float>(geometry_.coc_diameter_px(static_cast<double>(inverse_z)) / 2);
    }
    [[nodiscard]] Radii radii_px(const StackSample& s) const {
        const float own = radius_px(s.inverse_z);
        return {own, s.moved_inverse_z < 0 ? own : radius_px(s.moved_inverse_z)};
    }

    /// For each pixel, counts the steps in the direction `d` to the next edge: a pixel that shows a farther
    /// surface than the pixel before it. Sets `steps` to 0 if there is no edge.
    void find_steps(const Direction& d, std::vector<std::uint8_t>& steps) const {
        steps.assign(pixels(), 0);
        const int first = d.dx < 0 ? 1 : 0, end = d.dx > 0 ? width_ - 1 : width_;
        for (int row = 0; row < height_; ++row) {
            // The neighbour in direction `d` is visited before the pixel itself.
            const int y = d.dy > 0 ? height_ - 1 - row : row, v = y + d.dy;
            const bool inside = v >= 0 && v < height_;
            for (int x = 0; x < width_; ++x) {
                if (inside && x == first && first < end) x = end;
                if (x < width_ && in_raster(x + d.dx, v))
                    steps[index(x, y)] = is_farther(Radii{}, last_of(index(x, y))) ? 1 : 0;
            }
            if (!inside || first >= end) continue;
            const std::size_t here = index(first, y), next = index(first + d.dx, v);
            const auto count = static_cast<std::size_t>(end - first);
            if (blur_px_.empty()) {
                count_steps(d.dx > 0, here, next, count, steps, [this](std::size_t other, std::size_t own) {
                    return last_px_[other] - last_px_[own] >= least_step_px;
                });
            } else {
                count_steps(d.dx > 0, here, next, count, steps, [this](std::size_t other, std::size_t own) {
                    return is_farther(last_of(other), last_of(own));
                });
            }
        }
    }
    template <typename IsFarther>
    static void count_steps(bool backwards, std::size_t here, std::size_t next, std::size_t count,
                            std::vector<std::uint8_t>& steps, const IsFarther& is_farther_than) {
        const auto count_at = [&](std::size_t i) {
            const std::uint8_t beyond = steps[next + i];
            const auto steps_on = static_cast<std::uint8_t>(beyond + (beyond != 0 && beyond < many_steps));
            steps[here + i] = is_farther_than(next + i, here + i) ? std::uint8_t{1} : steps_on;
        };
        if (backwards) {
            for (std::size_t i = count; i-- > 0;) count_at(i);
        } else {
            for (std::size_t i = 0; i < count; ++i) count_at(i);
        }
    }

    [[nodiscard]] bool is_near_an_edge(std::size_t here) const {
        const float limit_px = limit_of(last_of(here).blur);
        bool is_near = false;
        for (const auto& steps : steps_to_farther_)
            is_near = is_near || (steps[here] != 0 && static_cast<float>(steps[here]) <= limit_px);
        return is_near;
    }

    /// Goes from the pixel (x, y) in `direction` to find a surface that the blurred image may show behind
    /// this pixel's own surface. Returns the first surface that is farther away and whose blur overlaps or
    /// touches the blur of the pixel. `own` has the pixel's CoC radii.
    [[nodiscard]] Find look(int x, int y, std::size_t direction, const Radii& own) const {
        const Direction& d = directions[direction];
        const float step_px = d.dx != 0 && d.dy != 0 ? 1.41421356F : 1;
        const float limit_px = limit_of(own.blur);
        for (int s = 0; is_stored(x, y);) {
            const int steps = steps_to_farther_[direction][index(x, y)];
            s += steps;
            const float distance_px = static_cast<float>(s) * step_px;
            if (steps == 0 || distance_px > limit_px) return {};
            x += steps * d.dx;
            y += steps * d.dy;
            if (steps == many_steps) continue;
            const Radii last = last_at(x, y);
            if (!is_farther(last, own) || !reach_each_other(distance_px, own, last)) continue;
            auto stack =
                is_stored(x, y) ? p_.stack(p_.x_begin + x, p_.y_begin + y) : std::span<const StackSample>();
            while (!stack.empty() && !is_farther(radii_px(stack[0]), own)) stack = stack.subspan(1);
            const bool fills = !stack.empty() && fills_[index(x, y)] != 0;
            return {distance_px, stack.empty() ? Radii{} : radii_px(stack[0]), stack, fills};
        }
        return {};
    }

    [[nodiscard]] static std::uint32_t id_of(const Find& f) { return f.stack.empty() ? 0 : f.stack[0].id; }
    [[nodiscard]] static double weight_of(const Find& f) {
        return 1 / (static_cast<double>(f.distance_px) * static_cast<double>(f.distance_px));
    }

    /// Keeps only those surfaces in `finds` that show one object: the object with the largest sum of weights.
    /// Otherwise, for example, a small light source near an edge would be mixed into the hidden surfaces
    /// along the whole edge.
    static std::size_t keep_most_seen(std::array<Find, directions.size()>& finds, std::size_t count) {
        std::uint32_t most = 0;
        double most_weight = 0;
        for (std::size_t i = 0; i < count; ++i) {
            double weight = 0;
            for (std::size_t k = 0; k < count; ++k)
                weight += id_of(finds[k]) == id_of(finds[i]) ? weight_of(finds[k]) : 0;
            if (weight > most_weight) {
                most_weight = weight;
                most = id_of(finds[i]);
            }
        }
        const auto kept =
            std::stable_partition(finds.begin(), finds.begin() + static_cast<std::ptrdiff_t>(count),
                                  [&](const Find& f) { return id_of(f) == most; });
        return static_cast<std::size_t>(kept - finds.begin());
    }

    [[nodiscard]] static std::array<double, 4> flattened(const Find& f) {
        std::array<double, 4> out{};
        double left = 1;
        for (const StackSample& s : f.stack) {
            out[0] += left * static_cast<double>(s.r);
            out[1] += left * static_cast<double>(s.g);
            out[2] += left * static_cast<double>(s.b);
            left *= 1 - static_cast<double>(s.alpha);
        }
        out[3] = 1 - left;
        return out;
    }

    const ForeignPicture& p_;
    const FocusGeometry& geometry_;
    float aberration_px_;
    int width_, height_;
    bool has_ids_;
    std::vector<float> last_px_,
        blur_px_;  ///< radii of every pixel; `blur_px_` is empty if it equals `last_px_`
    std::array<std::vector<std::uint8_t>, directions.size()> steps_to_farther_;
    std::vector<std::uint8_t> opaque_, fills_;
    float widest_px_ = 0;
};

BehindSearch::BehindSearch(const ForeignPicture& picture, const FocusGeometry& geometry, double aberration_px)
    : impl_(std::make_shared<const Impl>(picture, geometry, aberration_px)) {}

void BehindSearch::row(int y, std::vector<Behind>& out) const {
    out.clear();
    for (int x = 0; x < impl_->width(); ++x) out.push_back(impl_->behind(x, y - impl_->y_begin()));
}

std::vector<Behind> behind_fill(const ForeignPicture& picture, const FocusGeometry& geometry,
                                double aberration_px) {
    const BehindSearch search(picture, geometry, aberration_px);
    const auto width = static_cast<std::size_t>(picture.x_end - picture.x_begin),
               height = static_cast<std::size_t>(picture.y_end - picture.y_begin);
    require_memory(width * height * sizeof(Behind), "what is hidden in the picture");
    std::vector<Behind> out(width * height);
    parallel_for(height, [&](std::size_t row) {
        thread_local std::vector<Behind> of_row;
        search.row(picture.y_begin + static_cast<int>(row), of_row);
        std::copy(of_row.begin(), of_row.end(), out.begin() + static_cast<std::ptrdiff_t>(row * width));
    });
    return out;
}

namespace {

/// Summed-area table, which returns the sum of the values in any rectangle of a raster in constant time.
/// Values outside the raster count as 0.
class RectangleSums {
  public:
    RectangleSums(int width, int height, const std::vector<float>& values)
        : width_(width),
          height_(height),
          sums_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1), 0.0) {
        for (int y = 0; y < height; ++y) {
            double row = 0;
            for (int x = 0; x < width; ++x) {
                row +=
                    static_cast<double>(values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                               static_cast<std::size_t>(x)]);
                sums_[index(x + 1, y + 1)] = sums_[index(x + 1, y)] + row;
            }
        }
    }
    /// Returns the sum of the values in columns [x0, x1) of rows [y0, y1).
    [[nodiscard]] double of(int x0, int x1, int y0, int y1) const {
        const auto at = [&](int x, int y) {
            return sums_[index(std::clamp(x, 0, width_), std::clamp(y, 0, height_))];
        };
        return at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0);
    }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
               static_cast<std::size_t>(x);
    }
    int width_, height_;
    std::vector<double> sums_;
};

}  // namespace

std::vector<float> nothing_in_reach(const ForeignPicture& p, const FocusGeometry& geometry,
                                    const RasterWindow& window, double aberration_px) {
    const RasterWindow known = known_pixels(p);
    const auto pixels =
        static_cast<std::uint64_t>(known.width()) * static_cast<std::uint64_t>(known.height());
    require_memory(pixels * 20, "where nothing is in the picture");
    std::vector<float> left(pixels, 0.0F), radius_px(pixels, 0.0F);
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y - known.y_begin) * static_cast<std::size_t>(known.width()) +
               static_cast<std::size_t>(x - known.x_begin);
    };
    for (int y = known.y_begin; y < known.y_end; ++y) {
        for (int x = known.x_begin; x < known.x_end; ++x) {
            double through = 1, widest_px = 0;
            if (p.stores(x, y)) {
                for (const StackSample& s : p.stack(x, y)) {
                    through = 0;
                    widest_px = std::max(
                        widest_px,
                        std::abs(geometry.coc_diameter_px(static_cast<double>(s.spread_inverse_z())) / 2));
                }
            }
            left[at(x, y)] = static_cast<float>(std::max(through, 0.0));
            radius_px[at(x, y)] = static_cast<float>(widest_px);
        }
    }
    const RectangleSums sums(known.width(), known.height(), left);
    std::vector<float> out;
    out.reserve(static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height()));
    for (int y = window.y_begin; y < window.y_end; ++y) {
        for (int x = window.x_begin; x < window.x_end; ++x) {
            const std::size_t k = at(x, y);
            // Counts the pixels without a surface (empty space) in a square as wide as the blur of the
            // pixel's own samples.
            const double radius = std::min(static_cast<double>(radius_px[k]), DepthLevels::largest_radius_px);
            // The blur may reach 0.75 px farther than the CoC radius: 0.5 px because a pixel extends half its
            // width beyond its centre, and 0.25 px because kernels are computed for rounded depths.
            const int reach = static_cast<int>(std::ceil(radius + aberration_px + 0.75)) - 1;
            const int column = x - known.x_begin, row = y - known.y_begin;
            const double around = sums.of(column - reach, column + reach + 1, row - reach, row + reach + 1) /
                                  std::max(std::numbers::pi * radius * radius, 1.0);
            out.push_back(std::max(left[k], static_cast<float>(around)));
        }
    }
    return out;
}

}  // namespace postlens
