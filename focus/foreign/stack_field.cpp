#include "focus/foreign/stack_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "core/job.h"
#include "core/memory.h"
#include "core/sample_hash.h"
#include "core/threads.h"

namespace postlens {
namespace {

/// Rows of the image that one task draws for all views.
constexpr int rows_per_task = 32;
/// Number of a pixel's corners. The corner at (x, y), each 0 or 1, has the index x + 2 y.
constexpr std::size_t corners = 4;
/// Number of views that are drawn between two tests whether the job is cancelled.
constexpr std::size_t views_per_look = 16;

/// A sample of a pixel's stack as a quadrilateral with a depth at each corner.
struct Facet {
    std::array<float, corners> inverse_z{};  ///< at the corners of its pixel, 1/m
    StackSample sample;
    std::uint32_t threshold = 0;  ///< random bits by which it is opaque or transparent in a view
};

/// The samples of a picture as quadrilaterals, by pixel.
class Facets {
  public:
    Facets(const ForeignPicture& p, const std::vector<Behind>& behind, const FocusGeometry& geometry)
        : x_begin(p.x_begin),
          y_begin(p.y_begin),
          width(p.x_end - p.x_begin),
          height(p.y_end - p.y_begin),
          geometry_(geometry) {
        const auto known = static_cast<std::size_t>(std::count_if(
            behind.begin(), behind.end(), [](const Behind& b) { return b.known && b.alpha > 0; }));
        const std::size_t pixels = p.offsets.size() - 1;
        require_memory((p.samples.size() + known) * sizeof(Facet) + (pixels + 1) * sizeof(std::uint64_t),
                       "the samples as views draw them");
        facets_.reserve(p.samples.size() + known);
        offsets_.reserve(pixels + 1);
        offsets_.push_back(0);
        for (std::size_t i = 0; i < pixels; ++i) {
            for (std::uint64_t k = p.offsets[i]; k < p.offsets[i + 1]; ++k) add(i, p.samples[k]);
            if (!behind.empty() && behind[i].known && behind[i].alpha > 0) {
                const Behind& b = behind[i];
                add(i, {.inverse_z = b.inverse_z, .r = b.r, .g = b.g, .b = b.b, .alpha = b.alpha, .id = 0});
            }
            offsets_.push_back(facets_.size());
        }
        join_neighbours();
        find_ranges();
    }

    int x_begin, y_begin, width, height;

    [[nodiscard]] std::span<const Facet> at(std::size_t pixel) const {
        return std::span(facets_).subspan(offsets_[pixel], offsets_[pixel + 1] - offsets_[pixel]);
    }
    [[nodiscard]] std::uint64_t first_of(std::size_t pixel) const { return offsets_[pixel]; }
    [[nodiscard]] const Facet& facet(std::uint64_t number) const { return facets_[number]; }
    /// Smallest and largest inverse depth in a row of pixels; none where it holds no sample.
    [[nodiscard]] const std::pair<float, float>& range(int row) const {
        return ranges_[static_cast<std::size_t>(row)];
    }

  private:
    void add(std::size_t pixel, const StackSample& s) {
        Facet f;
        f.inverse_z.fill(s.spread_inverse_z());
        f.sample = s;
        f.threshold = random_word(pixel, static_cast<std::uint32_t>(facets_.size() - offsets_.back()));
        facets_.push_back(f);
    }
    [[nodiscard]] double radius_px(const Facet& f) const {
        return geometry_.coc_diameter_px(static_cast<double>(f.sample.spread_inverse_z())) / 2;
    }
    [[nodiscard]] bool one_surface(const Facet& a, const Facet& b) const {
        if (a.sample.id != 0 && b.sample.id != 0 && a.sample.id != b.sample.id) return false;
        constexpr double least_step_px = 1, share = 1.0 / 16;
        const double ra = radius_px(a), rb = radius_px(b);
        return std::abs(ra - rb) < std::max(least_step_px, share * std::min(std::abs(ra), std::abs(rb)));
    }
    /// The sample of a pixel that continues the surface of `f`; null where there is none.
    [[nodiscard]] const Facet* continued(const Facet& f, int x, int y) const {
        if (x < 0 || x >= width || y < 0 || y >= height) return nullptr;
        const Facet* best = nullptr;
        float apart = std::numeric_limits<float>::infinity();
        for (const Facet& other : at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                     static_cast<std::size_t>(x))) {
            const float d = std::abs(other.sample.spread_inverse_z() - f.sample.spread_inverse_z());
            if (d < apart && one_surface(f, other)) {
                apart = d;
                best = &other;
            }
        }
        return best;
    }
    void join_neighbours() {
        parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < width; ++x) {
                const std::size_t pixel = row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                for (std::uint64_t k = offsets_[pixel]; k < offsets_[pixel + 1]; ++k) join(facets_[k], x, y);
            }
        });
    }
    /// Sets the corner depths of `f` to the mean over the samples that continue its surface. Thread-safe,
    /// because no neighbour reads the corners.
    void join(Facet& f, int x, int y) const {
        std::array<const Facet*, 9> around{};
        for (int v = 0; v < 3; ++v) {
            for (int u = 0; u < 3; ++u) {
                if (u == 1 && v == 1) continue;
                around[3 * static_cast<std::size_t>(v) + static_cast<std::size_t>(u)] =
                    continued(f, x + u - 1, y + v - 1);
            }
        }
        for (std::size_t corner = 0; corner < corners; ++corner) {
            const std::size_t u = 2 * (corner % 2), v = 2 * (corner / 2);
            auto sum = static_cast<double>(f.sample.spread_inverse_z());
            int count = 1;
            for (const Facet* other : {around[3 + u], around[3 * v + 1], around[3 * v + u]}) {
                if (other == nullptr) continue;
                sum += static_cast<double>(other->sample.spread_inverse_z());
                ++count;
            }
            f.inverse_z[corner] = static_cast<float>(sum / count);
        }
    }
    void find_ranges() {
        ranges_.assign(static_cast<std::size_t>(height),
                       {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()});
        for (std::size_t row = 0; row < ranges_.size(); ++row) {
            auto& [least, most] = ranges_[row];
            for (std::uint64_t k = offsets_[row * static_cast<std::size_t>(width)];
                 k < offsets_[(row + 1) * static_cast<std::size_t>(width)]; ++k) {
                for (const float z : facets_[k].inverse_z) {
                    least = std::min(least, z);
                    most = std::max(most, z);
                }
            }
        }
    }

    FocusGeometry geometry_;
    std::vector<Facet> facets_;
    std::vector<std::uint64_t> offsets_;
    std::vector<std::pair<float, float>> ranges_;
};

/// A view: its lens point, and its sample position within the pixels.
struct View {
    float lens_x, lens_y;  ///< px m
    float inverse_focus_per_m;
    float x, y;  ///< what is added to every position: the lens's offset, less the place in the pixel, px
    std::uint32_t threshold;
    LensViewPoint point;
};

std::vector<View> views_of(const StackFieldSettings& s) {
    std::vector<View> out;
    constexpr std::uint32_t golden = 0x9E3779B9U;  // 2^32 times the golden ratio's fraction
    for (const LensViewPoint& p : lens_view_points(s.aperture, s.geometry, s.views, s.set)) {
        out.push_back({static_cast<float>(p.shift.lens_px.x), static_cast<float>(p.shift.lens_px.y),
                       static_cast<float>(p.shift.inverse_focus_per_m),
                       static_cast<float>(p.shift.offset_px.x - p.place.x),
                       static_cast<float>(p.shift.offset_px.y - p.place.y),
                       golden * static_cast<std::uint32_t>(out.size()), p});
    }
    return out;
}

/// The rows of the image that one task draws.
class Band {
  public:
    Band(const Facets& facets, const StackFieldSettings& s, int y_begin, int y_end)
        : facets_(facets),
          s_(s),
          y_begin_(y_begin),
          rows_(y_end - y_begin),
          width_(s.drawn.width()),
          nearest_(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(width_)),
          sums_(nearest_.size()),
          shares_(s.shares ? nearest_.size() : 0),
          passed_(s.aperture.varies_over_field() ? nearest_.size() : 0),
          half_diagonal_px_(std::hypot(s.window.width(), s.window.height()) / 2) {}

    void draw(const View& view) {
        std::fill(nearest_.begin(), nearest_.end(), Nearest{});
        hits_.clear();
        for (int row = 0; row < facets_.height; ++row) {
            if (!reaches(view, row)) continue;
            const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(facets_.width);
            for (int x = 0; x < facets_.width; ++x) {
                const std::size_t pixel = first + static_cast<std::size_t>(x);
                std::uint64_t number = facets_.first_of(pixel);
                for (const Facet& f : facets_.at(pixel))
                    meet(view, f, number++, facets_.x_begin + x, facets_.y_begin + row);
            }
        }
        take_hits(view);
    }

    void write(StackField& out) {
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const int x = s_.drawn.x_begin + static_cast<int>(i % static_cast<std::size_t>(width_)),
                      y = y_begin_ + static_cast<int>(i / static_cast<std::size_t>(width_));
            const std::size_t k = static_cast<std::size_t>(y - s_.window.y_begin) *
                                      static_cast<std::size_t>(s_.window.width()) +
                                  static_cast<std::size_t>(x - s_.window.x_begin);
            const auto views = static_cast<float>(s_.views);
            for (std::size_t c = 0; c < 3; ++c) out.image.rgb[3 * k + c] = sums_[i].rgba[c] / views;
            // A view whose light the lens blocks is black, so colours are means over all views. It does not
            // affect alpha, which is the mean over the other views.
            const float passed = passed_.empty() ? views : passed_[i];
            out.image.alpha[k] = passed > 0 ? std::min(sums_[i].rgba[3] / passed, 1.0F) : 1;
            if (!shares_.empty() && passed > 0) {
                for (ObjectShare& o : shares_[i]) o.share /= passed;
                out.shares[k] = std::move(shares_[i]);
            }
            out.unseen[k] = passed > 0 ? sums_[i].unseen / passed : 0;
        }
    }

  private:
    struct Nearest {
        float inverse_z = -1;  ///< of the nearest opaque quadrilateral; below 0: none
        std::uint64_t number = ~std::uint64_t{0};
    };
    struct Sum {
        std::array<float, 4> rgba{};
        float unseen = 0;
    };
    struct Hit {
        std::uint32_t at;
        float inverse_z;
        std::uint64_t number;
    };

    /// Whether a row of pixels may reach this band.
    [[nodiscard]] bool reaches(const View& v, int row) const {
        const auto& [least, most] = facets_.range(row);
        if (!(least <= most)) return false;
        const float a = v.lens_y * (v.inverse_focus_per_m - least),
                    b = v.lens_y * (v.inverse_focus_per_m - most);
        constexpr float margin_px = 2;
        const float y = static_cast<float>(facets_.y_begin + row) + v.y;
        return y + std::max(a, b) + margin_px >= static_cast<float>(y_begin_) &&
               y + std::min(a, b) - margin_px <= static_cast<float>(y_begin_ + rows_);
    }

    /// Finds the view's sample points inside a quadrilateral. In the view's coordinates, they are at
    /// integers.
    void meet(const View& v, const Facet& f, std::uint64_t number, int x, int y) {
        std::array<float, corners> px{}, py{};
        for (std::size_t c = 0; c < corners; ++c) {
            const float apart = v.inverse_focus_per_m - f.inverse_z[c];
            px[c] = static_cast<float>(x + static_cast<int>(c % 2)) + v.x + v.lens_x * apart;
            py[c] = static_cast<float>(y + static_cast<int>(c / 2)) + v.y + v.lens_y * apart;
        }
        const auto [left, right] = std::minmax({px[0], px[1], px[2], px[3]});
        const auto [top, bottom] = std::minmax({py[0], py[1], py[2], py[3]});
        if (!(right >= static_cast<float>(s_.drawn.x_begin) && left <= static_cast<float>(s_.drawn.x_end) &&
              bottom >= static_cast<float>(y_begin_) && top <= static_cast<float>(y_begin_ + rows_)))
            return;
        const int u_begin = std::max(static_cast<int>(std::ceil(left)), s_.drawn.x_begin),
                  u_end = std::min(static_cast<int>(std::floor(right)), s_.drawn.x_end - 1),
                  w_begin = std::max(static_cast<int>(std::ceil(top)), y_begin_),
                  w_end = std::min(static_cast<int>(std::floor(bottom)), y_begin_ + rows_ - 1);
        for (int w = w_begin; w <= w_end; ++w) {
            for (int u = u_begin; u <= u_end; ++u) {
                if (inside(px, py, static_cast<float>(u), static_cast<float>(w)))
                    hit(v, f, number,
                        static_cast<std::size_t>(w - y_begin_) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(u - s_.drawn.x_begin));
            }
        }
    }

    /// Whether a point lies in one of the quadrilateral's two triangles, whatever their orientation. The
    /// sides count as inside, so that neighbours leave no crack.
    [[nodiscard]] static bool inside(const std::array<float, corners>& px,
                                     const std::array<float, corners>& py, float x, float y) {
        const auto side = [&](std::size_t a, std::size_t b) {
            // The side starts at the corner that comes first in order, so that both neighbours of the side
            // compute the same number.
            return (px[b] - px[a]) * (y - py[a]) - (py[b] - py[a]) * (x - px[a]);
        };
        const float top = side(0, 1), right = side(1, 3), bottom = side(2, 3), left = side(0, 2),
                    diagonal = side(0, 3);
        return (top >= 0 && right >= 0 && diagonal <= 0) || (left <= 0 && bottom <= 0 && diagonal >= 0) ||
               (top <= 0 && right <= 0 && diagonal >= 0) || (left >= 0 && bottom >= 0 && diagonal <= 0);
    }

    void hit(const View& v, const Facet& f, std::uint64_t number, std::size_t at) {
        const float z = f.sample.inverse_z;
        Nearest& n = nearest_[at];
        if (is_behind(z, number, n)) return;
        hits_.push_back({static_cast<std::uint32_t>(at), z, number});
        const double share = static_cast<double>(f.threshold + v.threshold) * 0x1p-32;
        if (share < static_cast<double>(f.sample.alpha)) n = {z, number};
    }
    /// Whether a quadrilateral is behind the nearest one so far. Of two at equal depth, the one with the
    /// smaller number is in front.
    [[nodiscard]] static bool is_behind(float z, std::uint64_t number, const Nearest& n) {
        return z < n.inverse_z || (z == n.inverse_z && number > n.number);
    }

    /// Adds the premultiplied light of all quadrilaterals that no opaque one hides. The expected value is
    /// that of the operator "over".
    void take_hits(const View& v) {
        if (!passed_.empty()) find_passing(v);
        for (const Hit& h : hits_) {
            if (is_behind(h.inverse_z, h.number, nearest_[h.at])) continue;
            if (!passed_.empty() && passes_[h.at] == 0) continue;
            const StackSample& s = facets_.facet(h.number).sample;
            Sum& sum = sums_[h.at];
            if (!s.holdout) {
                sum.rgba[0] += s.r;
                sum.rgba[1] += s.g;
                sum.rgba[2] += s.b;
                sum.rgba[3] += s.alpha;
                if (!shares_.empty()) add_share(shares_[h.at], s);
            }
            if (met_.empty()) met_.resize(sums_.size());
            met_[h.at] = 1;
        }
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const bool met = !met_.empty() && met_[i] != 0;
            if (!met && (passed_.empty() || passes_[i] != 0)) ++sums_[i].unseen;
        }
        std::fill(met_.begin(), met_.end(), std::uint8_t{0});
    }
    void add_share(std::vector<ObjectShare>& of_pixel, const StackSample& s) const {
        constexpr double in_focus_px = 1;
        const double coc_px = s_.geometry.coc_diameter_px(static_cast<double>(s.spread_inverse_z()));
        const int side = std::abs(coc_px) <= in_focus_px ? 0 : coc_px < 0 ? -1 : 1;
        const auto same = std::find_if(of_pixel.begin(), of_pixel.end(),
                                       [&](const ObjectShare& o) { return o.id == s.id && o.side == side; });
        if (same != of_pixel.end()) {
            same->share += s.alpha;
        } else {
            of_pixel.push_back({s.id, side, s.alpha});
        }
    }
    /// Finds the views whose light the lens transmits to each pixel, by where the view's ray meets the plane
    /// in focus.
    void find_passing(const View& v) {
        passes_.resize(passed_.size());
        const glm::dvec2 middle((s_.window.x_begin + s_.window.x_end) / 2.0,
                                (s_.window.y_begin + s_.window.y_end) / 2.0);
        for (std::size_t i = 0; i < passed_.size(); ++i) {
            const glm::dvec2 at(s_.drawn.x_begin + static_cast<int>(i % static_cast<std::size_t>(width_)),
                                y_begin_ + static_cast<int>(i / static_cast<std::size_t>(width_)));
            const glm::dvec2 field =
                at + v.point.place - middle - v.point.shift.inverse_focus_per_m * v.point.shift.lens_px;
            passes_[i] = s_.aperture.passes(v.point.lens, field / half_diagonal_px_) ? 1 : 0;
            passed_[i] += static_cast<float>(passes_[i]);
        }
    }

    const Facets& facets_;
    const StackFieldSettings& s_;
    int y_begin_, rows_, width_;
    std::vector<Nearest> nearest_;
    std::vector<Hit> hits_;
    std::vector<Sum> sums_;
    std::vector<std::uint8_t> met_, passes_;
    std::vector<std::vector<ObjectShare>> shares_;
    std::vector<float> passed_;  ///< views that the lens lets through; empty: all
    double half_diagonal_px_;
};

}  // namespace

StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                       const StackFieldSettings& settings) {
    const std::vector<View> views = views_of(settings);
    const Facets facets(picture, behind, settings.geometry);
    StackField out;
    out.image = Image(settings.window.width(), settings.window.height());
    const std::size_t pixels = out.image.rgb.size() / 3;
    out.image.alpha.resize(pixels);
    out.unseen.resize(pixels);
    if (settings.shares) out.shares.resize(pixels);
    const auto bands =
        static_cast<std::size_t>((settings.drawn.height() + rows_per_task - 1) / rows_per_task);
    parallel_for(bands, [&](std::size_t task) {
        const int y_begin = settings.drawn.y_begin + static_cast<int>(task) * rows_per_task;
        Band band(facets, settings, y_begin, std::min(y_begin + rows_per_task, settings.drawn.y_end));
        for (std::size_t i = 0; i < views.size(); ++i) {
            if (i % views_per_look == 0) throw_if_interrupted();
            band.draw(views[i]);
        }
        band.write(out);
    });
    return out;
}

}  // namespace postlens
