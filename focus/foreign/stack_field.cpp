#include "focus/foreign/stack_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/job.h"
#include "core/sample_hash.h"
#include "core/sobol.h"
#include "core/threads.h"
#include "focus/foreign/stack_facets.h"

namespace postlens {
namespace {

/// Rows of the image that one task draws for all views.
constexpr int rows_per_task = 32;
/// Number of views between two checks for cancellation of the job.
constexpr std::size_t views_per_look = 16;

/// A view: the image that one lens point sees, drawn with one sample per pixel. Within a view, the sample
/// lies at the same position in every pixel. This position differs from view to view, so their mean has
/// smooth edges.
struct View {
    float lens_x, lens_y;  ///< shift of the image by the lens point, in px per 1/m of inverse depth
    float inverse_focus_per_m;
    float x, y;  ///< shift of every position, px: shift by the lens minus sample position in the pixel
    std::uint32_t number;
    LensViewPoint point;
};

std::vector<View> views_of(const StackFieldSettings& s) {
    std::vector<View> out;
    for (const LensViewPoint& p : lens_view_points(s.aperture, s.geometry, s.views, s.set)) {
        out.push_back({static_cast<float>(p.shift.lens_px.x), static_cast<float>(p.shift.lens_px.y),
                       static_cast<float>(p.shift.inverse_focus_per_m),
                       static_cast<float>(p.shift.offset_px.x - p.place.x),
                       static_cast<float>(p.shift.offset_px.y - p.place.y),
                       static_cast<std::uint32_t>(out.size()), p});
    }
    return out;
}

/// Returns, for each pixel, 1 if empty space lies behind all samples of the pixel, otherwise 0.
std::vector<std::uint8_t> nothing_behind(const ForeignPicture& p, const std::vector<Behind>& behind,
                                         const RasterWindow& window) {
    std::vector<std::uint8_t> out;
    out.reserve(static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height()));
    for (int y = window.y_begin; y < window.y_end; ++y) {
        for (int x = window.x_begin; x < window.x_end; ++x) {
            if (!p.stores(x, y)) {
                out.push_back(x >= 0 && x < p.width && y >= 0 && y < p.height ? 1 : 0);
                continue;
            }
            const std::size_t k = p.pixel_at(x, y);
            out.push_back(transmittance_behind(p.stack_of(k), p.is_nothing_behind(k)) >
                                      opaque_transmittance ||
                                  (!behind.empty() && behind[k].known && behind[k].alpha < 1)
                              ? 1
                              : 0);
        }
    }
    return out;
}

/// Returns whether the sample `f` counts as opaque when it is seen from the lens point number `view`. A
/// translucent sample counts as opaque for a random part of the lens points, equal to its alpha, and as
/// transparent for all others. So the mean over all lens points is correct (stochastic transparency).
bool is_opaque(const Facet& f, std::uint32_t view) {
    if (f.sample.alpha >= 1) return true;
    // The sample counts as opaque if its alpha exceeds a pseudo-random number: the one with the index `view`
    // in a scrambled van der Corput sequence. Each sample has its own scrambling, f.seed, so the samples of a
    // pixel are opaque independently of each other.
    const std::uint32_t place = reverse_bits(owen_scramble_reversed(reverse_bits(view), f.seed));
    const std::uint32_t bits = reverse_bits(owen_scramble_reversed(place, mix32(f.seed)));
    return static_cast<double>(bits) * 0x1p-32 < static_cast<double>(f.sample.alpha);
}

/// The rows of the image that one task draws.
class Band {
  public:
    /// `nothing` states for each pixel whether empty space lies behind the pixel's farthest sample (1) or not
    /// (0). In such a pixel, a lens point that sees no surface lacks nothing, so the pixel stays translucent.
    Band(const Facets& facets, const std::vector<std::uint8_t>& nothing, const StackFieldSettings& s,
         int y_begin, int y_end)
        : facets_(facets),
          nothing_(nothing),
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
        std::fill(nearest_.begin(), nearest_.end(), Depth{});
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
            const std::size_t k = in_window(i);
            const auto views = static_cast<float>(s_.views);
            for (std::size_t c = 0; c < 3; ++c)
                out.image.rgb[3 * k + c] = static_cast<float>(sums_[i].rgba[c] / s_.views);
            // The aperture may block some lens points for a pixel near the image's corner (vignetting). This
            // makes the pixel darker, but must not make it translucent. Therefore, alpha is divided by
            // `passed`, the number of lens points that are not blocked, and not by the number of all lens
            // points.
            const float passed = passed_.empty() ? views : passed_[i];
            const auto alpha = static_cast<float>(sums_[i].rgba[3]);
            out.image.alpha[k] = passed > 0 ? alpha / passed : 1;
            if (!shares_.empty() && passed > 0) {
                for (ObjectShare& o : shares_[i]) o.share /= passed;
                out.shares[k] = std::move(shares_[i]);
            }
            const float covered = passed > 0 ? (alpha + sums_[i].held_out) / passed : 1;
            out.unseen[k] = passed > 0 && nothing_[k] == 0 ? sums_[i].unseen / passed : 0;
            // If the file shows empty space in the pixel, the pixel may really be translucent. The division
            // by `covered` must then not increase its alpha.
            out.covered[k] = nothing_[k] == 0 ? covered : std::max(covered, 1.0F);
        }
    }

  private:
    struct Depth {
        float inverse_z = -1;  ///< farther than all if negative
        std::uint32_t layer = ~std::uint32_t{0};
        std::uint64_t number = ~std::uint64_t{0};
        [[nodiscard]] bool is_behind(const Depth& other) const {
            if (inverse_z != other.inverse_z) return inverse_z < other.inverse_z;
            return layer != other.layer ? layer > other.layer : number > other.number;
        }
    };
    struct Sum {
        std::array<double, 4> rgba{};  ///< a sum of floats may exceed the largest float
        float unseen = 0;              ///< number of views that see past everything in the image
        float held_out = 0;            ///< sum of the alphas of holdouts
    };
    struct Hit {
        std::uint32_t at;
        Depth depth;
    };

    [[nodiscard]] std::size_t in_window(std::size_t i) const {
        const int x = s_.drawn.x_begin + static_cast<int>(i % static_cast<std::size_t>(width_)),
                  y = y_begin_ + static_cast<int>(i / static_cast<std::size_t>(width_));
        return static_cast<std::size_t>(y - s_.window.y_begin) * static_cast<std::size_t>(s_.window.width()) +
               static_cast<std::size_t>(x - s_.window.x_begin);
    }

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

    /// Finds the pixels that a quadrilateral covers when it is seen from one lens point. A pixel counts as
    /// covered if the quadrilateral contains the pixel's sample position. Coordinates are shifted so that
    /// this position is (column, row), which are integers.
    void meet(const View& v, const Facet& f, std::uint64_t number, int x, int y) {
        std::array<float, Facet::corners> px{}, py{};
        for (std::size_t c = 0; c < Facet::corners; ++c) {
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

    /// Returns whether a point lies in one of the two triangles into which a diagonal divides a
    /// quadrilateral. Their corners may be in clockwise or anticlockwise order. Points on a side count as
    /// inside, to avoid gaps between neighbours.
    [[nodiscard]] static bool inside(const std::array<float, Facet::corners>& px,
                                     const std::array<float, Facet::corners>& py, float x, float y) {
        const auto side = [&](std::size_t a, std::size_t b) {
            // Returns on which side of the line from corner a to corner b the point (x, y) lies, as the sign
            // of a cross product. Two neighbouring quadrilaterals compute exactly the same value for their
            // common side. So each point near the side belongs to at least one of them.
            return (px[b] - px[a]) * (y - py[a]) - (py[b] - py[a]) * (x - px[a]);
        };
        const float top = side(0, 1), right = side(1, 3), bottom = side(2, 3), left = side(0, 2),
                    diagonal = side(0, 3);
        return (top >= 0 && right >= 0 && diagonal <= 0) || (left <= 0 && bottom <= 0 && diagonal >= 0) ||
               (top <= 0 && right <= 0 && diagonal >= 0) || (left >= 0 && bottom >= 0 && diagonal <= 0);
    }

    void hit(const View& v, const Facet& f, std::uint64_t number, std::size_t at) {
        const Depth depth{f.sample.inverse_z, f.layer, number};
        Depth& nearest = nearest_[at];
        if (depth.is_behind(nearest)) return;
        hits_.push_back({static_cast<std::uint32_t>(at), depth});
        if (is_opaque(f, v.number)) nearest = depth;
    }

    /// Adds what the lens point `v` sees in each pixel to the sums over all lens points: the premultiplied
    /// colours of the nearest opaque sample and of all samples in front of it.
    void take_hits(const View& v) {
        if (!passed_.empty()) find_passing(v);
        for (const Hit& h : hits_) {
            if (h.depth.is_behind(nearest_[h.at])) continue;
            if (!passed_.empty() && passes_[h.at] == 0) continue;
            const StackSample& s = facets_.facet(h.depth.number).sample;
            Sum& sum = sums_[h.at];
            if (!s.holdout) {
                sum.rgba[0] += static_cast<double>(s.r);
                sum.rgba[1] += static_cast<double>(s.g);
                sum.rgba[2] += static_cast<double>(s.b);
                sum.rgba[3] += static_cast<double>(s.alpha);
                if (!shares_.empty()) add_share(shares_[h.at], s);
            } else {
                sum.held_out += s.alpha;
            }
        }
        // Counts for each pixel, in `unseen`, the lens points that see no surface of the file there. A
        // surface that was only extended beyond the image border (`beyond`) does not count as seen. Lens
        // points that the aperture blocks are not counted.
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const bool ends = nearest_[i].inverse_z >= 0 && !facets_.facet(nearest_[i].number).beyond;
            if (!ends && (passed_.empty() || passes_[i] != 0)) ++sums_[i].unseen;
        }
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
    /// Tests for each pixel whether light passes through the lens at the lens point of `v`. Towards the
    /// image's corners, parts of the lens block it (vignetting).
    void find_passing(const View& v) {
        passes_.resize(passed_.size());
        const glm::dvec2 middle((s_.window.x_begin + s_.window.x_end) / 2.0,
                                (s_.window.y_begin + s_.window.y_end) / 2.0);
        for (std::size_t i = 0; i < passed_.size(); ++i) {
            const glm::dvec2 at(s_.drawn.x_begin + static_cast<int>(i % static_cast<std::size_t>(width_)),
                                y_begin_ + static_cast<int>(i / static_cast<std::size_t>(width_)));
            // Which parts block light depends on `field`, the position in the image at which the pixel's ray
            // crosses the plane in focus, relative to the image's centre.
            const glm::dvec2 field =
                at + v.point.place - middle - v.point.shift.inverse_focus_per_m * v.point.shift.lens_px;
            passes_[i] = s_.aperture.passes(v.point.lens, field / half_diagonal_px_) ? 1 : 0;
            passed_[i] += static_cast<float>(passes_[i]);
        }
    }

    const Facets& facets_;
    const std::vector<std::uint8_t>& nothing_;
    const StackFieldSettings& s_;
    int y_begin_, rows_, width_;
    std::vector<Depth> nearest_;  ///< per pixel, the nearest opaque quadrilateral of the view
    std::vector<Hit> hits_;
    std::vector<Sum> sums_;
    std::vector<std::uint8_t> passes_;
    std::vector<std::vector<ObjectShare>> shares_;
    std::vector<float> passed_;  ///< per pixel, number of views that the lens transmits; empty if all are
    double half_diagonal_px_;
};

}  // namespace

StackField stack_field(const ForeignPicture& picture, const std::vector<Behind>& behind,
                       const StackFieldSettings& settings) {
    const std::vector<View> views = views_of(settings);
    const BorderExtension border(picture, around_aperture(settings.geometry, settings.aperture),
                                 settings.aberration_px());
    const Facets facets(picture, behind, border, settings.geometry);
    const std::vector<std::uint8_t> nothing = nothing_behind(picture, behind, settings.window);
    StackField out;
    out.image = Image(settings.window.width(), settings.window.height());
    const std::size_t pixels = out.image.rgb.size() / 3;
    out.image.alpha.resize(pixels);
    out.unseen.resize(pixels);
    out.covered.resize(pixels, 1.0F);
    if (settings.shares) out.shares.resize(pixels);
    const auto bands =
        static_cast<std::size_t>((settings.drawn.height() + rows_per_task - 1) / rows_per_task);
    parallel_for(bands, [&](std::size_t task) {
        const int y_begin = settings.drawn.y_begin + static_cast<int>(task) * rows_per_task;
        Band band(facets, nothing, settings, y_begin,
                  std::min(y_begin + rows_per_task, settings.drawn.y_end));
        for (std::size_t i = 0; i < views.size(); ++i) {
            if (i % views_per_look == 0) throw_if_interrupted();
            band.draw(views[i]);
        }
        band.write(out);
    });
    return out;
}

void divide_by_covered(StackField& field) {
    for (std::size_t k = 0; k < field.covered.size(); ++k) {
        const float covered = field.covered[k];
        if (!(covered > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) field.image.rgb[3 * k + c] /= covered;
        field.image.alpha[k] = std::min(field.image.alpha[k] / covered, 1.0F);
    }
}

}  // namespace postlens
