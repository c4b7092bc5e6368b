#include "focus/field_focus.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "focus/field_highlights.h"
#include "focus/lens_views.h"
#include "focus/one_surface.h"
#include "records/crop.h"
#include "reproject/fill_gaps.h"
#include "reproject/instants_around.h"
#include "reproject/patch_field.h"

namespace postlens {
namespace {

/// Which pixels of the window light through a point of the lens gets to.
std::function<bool(int, int)> passing(const FieldFocusSettings& s, const LensViewPoint& view) {
    if (!s.aperture.varies_over_field()) return {};
    const glm::dvec2 middle(s.window.width() / 2.0, s.window.height() / 2.0);
    const double half_diagonal_px = glm::length(middle);
    return [&s, view, middle, half_diagonal_px](int x, int y) {
        const glm::dvec2 field =
            glm::dvec2(x, y) + view.place - middle - view.shift.inverse_focus_per_m * view.shift.lens_px;
        return s.aperture.passes(view.lens, field / half_diagonal_px);
    };
}

/// The reversed binary digits of i, as a fraction: with i itself a set of low discrepancy.
double reversed(std::uint32_t i) {
    std::uint32_t out = 0;
    for (std::uint32_t bit = 0x80000000U; i != 0; i >>= 1U, bit >>= 1U) out |= (i & 1U) != 0 ? bit : 0U;
    return out / 4294967296.0;
}

/// From one set of views to the next, in time: far from the multiples of small fractions.
constexpr double set_shift = 0.38196601125010515;

/// Which ids move alike, and how.
class Motions {
  public:
    explicit Motions(const FieldShutter& shutter) : shutter_(shutter) {
        const FrameMotion& m = *shutter.motion;
        for (const std::uint32_t id : m.moving_ids()) {
            classes_.emplace(id, ids_.size() + 1);
            ids_.push_back(id);
        }
        camera_ = m.camera_moves(shutter.open_s, shutter.close_s);
    }
    [[nodiscard]] bool any() const { return camera_ || !ids_.empty(); }
    [[nodiscard]] std::size_t class_of(std::uint32_t id) const {
        const auto found = classes_.find(id);
        return found == classes_.end() ? 0 : found->second;
    }
    [[nodiscard]] bool moves(std::uint32_t id) const { return camera_ || class_of(id) != 0; }
    /// By class: from one instant to another.
    [[nodiscard]] std::vector<RasterMap> maps(double from_s, double to_s) const {
        constexpr std::uint32_t no_id = 0xFFFFFFFFU;  // what has no motion of its own
        std::vector<RasterMap> out{shutter_.motion->map(no_id, from_s, to_s)};
        for (const std::uint32_t id : ids_) out.push_back(shutter_.motion->map(id, from_s, to_s));
        return out;
    }

  private:
    const FieldShutter& shutter_;
    std::vector<std::uint32_t> ids_;
    std::unordered_map<std::uint32_t, std::size_t> classes_;
    bool camera_ = false;
};

/// The recorded instants that a moment is seen from, each moved to it.
std::vector<PatchView::Use> uses_at(const std::vector<double>& instants_s, double time_s,
                                    const Motions& motions) {
    std::vector<PatchView::Use> out;
    for (const InstantShare& i : instants_around(instants_s, time_s))
        out.push_back({i.instant, i.share, motions.maps(instants_s[i.instant], time_s)});
    return out;
}

/// The tiles that have something of the crop. Gaps in it are filled from around, however far away that is:
/// then all are.
PatchPicture drawn(PatchField& field, const std::optional<OneSurface>& simple,
                   const std::optional<Crop>& crop) {
    if (!crop) return patch_field(field);
    const auto all = field.wanted;
    field.wanted = [all, part = *crop](int x, int y, int width, int height) {
        return part.meets(x, y, width, height) && (!all || all(x, y, width, height));
    };
    PatchPicture seen = patch_field(field);
    for (int y = crop->y; y < crop->y + crop->height; ++y) {
        for (int x = crop->x; x < crop->x + crop->width; ++x) {
            const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) +
                                  static_cast<std::size_t>(x);
            if (seen.unknown[k] < 1 || (simple && simple->at(x, y))) continue;
            field.wanted = all;
            return patch_field(field);
        }
    }
    return seen;
}

}  // namespace

double FieldFocus::unknown_share(const std::optional<Crop>& crop) const {
    const std::vector<float> asked = cut(unknown, image.width, crop);
    return std::accumulate(asked.begin(), asked.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(asked.size(), 1));
}

struct FieldFocuser::Prepared {
    std::optional<Motions> motions;
    bool moves = false;
    std::vector<std::shared_ptr<const TreeSheets>> sheets;
    std::vector<PatchMesh> primary, deeper;
    std::vector<double> instants_s;
};

FieldFocuser::~FieldFocuser() = default;

FieldFocuser::FieldFocuser(FocusFrame& frame, const FieldFocusSettings& settings)
    : settings_(settings), prepared_(std::make_unique<Prepared>()) {
    const SampleFileReader& file = frame.file();
    const FocusGeometry& g = settings_.geometry;
    Prepared& p = *prepared_;
    const PatchLens lens{g.gain_px * g.aperture_radius_m, g.inverse_focus_per_m};
    if (settings_.shutter) p.motions.emplace(*settings_.shutter);
    p.moves = p.motions && p.motions->any();
    // What moves through the frame blurs its highlights itself.
    HighlightRule rule = highlight_rule(settings_.aperture, g);
    if (rule.takes && p.moves) {
        rule.takes = [takes = rule.takes, &p](const Mat2& w, std::uint32_t id, float area_px2) {
            return !p.motions->moves(id) && takes(w, id, area_px2);
        };
    }
    const std::size_t instants = p.moves || settings_.shutter ? file.instants() : 1;
    p.sheets.reserve(instants);
    for (std::size_t i = 0; i < instants; ++i) {
        p.sheets.push_back(
            frame.sheets(i, instants == 1 ? rule : HighlightRule{}, i == 0 ? settings_.also : RecordsRead{}));
        p.instants_s.push_back(file.instant_s(i));
        p.primary.push_back(cut_patches(p.sheets[i]->primary, lens));
        p.deeper.push_back(cut_patches(p.sheets[i]->deeper, lens));
    }
}

FieldFocus FieldFocuser::draw(const FieldViews& views) const {
    const Prepared& p = *prepared_;
    const FocusGeometry& g = settings_.geometry;
    const std::size_t instants = p.sheets.size();
    PatchField field;
    field.x = settings_.window.x_begin;
    field.y = settings_.window.y_begin;
    field.width = settings_.window.width();
    field.height = settings_.window.height();
    for (std::size_t i = 0; i < instants; ++i)
        field.instants.push_back({&p.primary[i], p.deeper[i].patches.empty() ? nullptr : &p.deeper[i]});
    if (p.moves) field.motion_class = [&p](std::uint32_t id) { return p.motions->class_of(id); };
    const std::vector<LensViewPoint> points = lens_view_points(settings_.aperture, g, views.count, views.set);
    const FieldHighlights highlights(*p.sheets[0], settings_.aperture, g, points, views.set,
                                     settings_.window);
    if (highlights.any()) {
        field.lights = &highlights;
        field.lens_reach_px = g.gain_px * g.aperture_radius_m * settings_.aperture.half_extent();
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        PatchView v;
        v.sample = points[i].place;
        v.lens = points[i].shift;
        v.passes = passing(settings_, points[i]);
        v.uses = {{0, 1, {}}};
        if (settings_.shutter && (p.moves || instants > 1)) {
            const FieldShutter& s = *settings_.shutter;
            double u = std::min(1.0, reversed(static_cast<std::uint32_t>(i)) + 0.5 / views.count);
            if (views.set > 0) u = std::fmod(u + views.set * set_shift, 1.0);
            v.uses = uses_at(p.instants_s, s.open_s + s.curve.time(u) * (s.close_s - s.open_s), *p.motions);
            if (!p.moves) {
                for (auto& use : v.uses) use.motions.clear();
            }
        }
        field.views.push_back(std::move(v));
    }
    std::optional<OneSurface> simple;
    if (views.leave_out_from_share && !p.moves && instants == 1) {
        simple = find_one_surface(p.primary[0], p.deeper[0],
                                  g.gain_px * g.aperture_radius_m * settings_.aperture.half_extent(),
                                  g.inverse_focus_per_m, settings_.window);
        if (simple->share() < *views.leave_out_from_share) simple.reset();
    }
    field.wanted = views.wanted;
    if (simple) {
        field.wanted = [&simple, &views](int x, int y, int width, int height) {
            return !simple->all(x, y, width, height) && (!views.wanted || views.wanted(x, y, width, height));
        };
    }
    PatchPicture seen = drawn(field, simple, settings_.crop);
    FieldFocus out;
    if (simple) {
        out.left_out.resize(seen.unknown.size());
        for (std::size_t k = 0; k < out.left_out.size(); ++k) {
            const auto width = static_cast<std::size_t>(field.width);
            const bool left = simple->at(static_cast<int>(k % width), static_cast<int>(k / width));
            out.left_out[k] = left ? 1 : 0;
            if (left) seen.unknown[k] = 0;
        }
    }
    std::vector<float> known(seen.unknown.size());
    for (std::size_t k = 0; k < known.size(); ++k) known[k] = 1 - seen.unknown[k];
    fill_gaps(seen.image, known);
    out.image = std::move(seen.image);
    out.unknown = std::move(seen.unknown);
    out.unknown_below = std::move(seen.unknown_below);
    return out;
}

FieldFocus field_focus(FocusFrame& frame, const FieldFocusSettings& settings) {
    return FieldFocuser(frame, settings).draw({settings.views, 0, {}, settings.leave_out_from_share});
}

}  // namespace postlens
