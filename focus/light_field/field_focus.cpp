#include "focus/light_field/field_focus.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "core/sample_hash.h"
#include "core/threads.h"
#include "focus/light_field/bright_edges.h"
#include "focus/light_field/field_highlights.h"
#include "focus/light_field/field_surfaces.h"
#include "focus/light_field/highlights_with_rays.h"
#include "focus/light_field/lens_views.h"
#include "focus/light_field/one_surface.h"
#include "reproject/fill_gaps.h"
#include "reproject/instants_around.h"
#include "reproject/patch_field.h"

namespace postlens {
namespace {

/// Returns a function that tells whether light from the lens point of `view` passes the aperture on its way
/// to the image pixel (x, y). The returned function is empty if all pixels see the same aperture.
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

/// Gives each kind of motion in the scene a number. An object that moves by itself has a number of its own,
/// from 1. All other objects have the number 0: they shift in the image only if the camera moves.
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
    /// Returns how points of objects move on the raster between two instants, in s. The first element
    /// contains the motion of the camera, for all objects that do not move by themselves. Then follows one
    /// element for each moving object.
    [[nodiscard]] std::vector<RasterMap> maps(double from_s, double to_s) const {
        constexpr std::uint32_t no_id = 0xFFFFFFFFU;  // an object without its own motion
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

/// Returns how to draw the scene at the instant `time_s`, in s, from the few instants that the sample file
/// records. Each element is a recorded instant near `time_s`, with its weight and with the motion of each
/// object from then to `time_s`.
std::vector<PatchView::Use> uses_at(const std::vector<double>& instants_s, double time_s,
                                    const Motions& motions) {
    std::vector<PatchView::Use> out;
    for (const InstantShare& i : instants_around(instants_s, time_s))
        out.push_back({i.instant, i.share, motions.maps(instants_s[i.instant], time_s)});
    return out;
}

/// Returns whether the rectangle `crop` of the image `seen` contains a gap, a pixel that should be drawn, but
/// in which no lens point sees a recorded surface. Gaps are filled from the surrounding pixels, so pixels
/// outside `crop` are then needed, too.
bool has_gaps(const PatchPicture& seen, std::size_t number, std::span<const FieldViews> sets, int piece_px,
              const std::optional<OneSurface>& simple, const Crop& crop) {
    std::atomic<bool> found = false;
    parallel_for(static_cast<std::size_t>(seen.image.height), [&](std::size_t row) {
        const int y = static_cast<int>(row), end = crop.x + crop.width;
        if (found || y < crop.y || y >= crop.y + crop.height) return;
        for (int x = crop.x; x < end && !found; ++x) {
            const std::size_t k =
                row * static_cast<std::size_t>(seen.image.width) + static_cast<std::size_t>(x);
            if (seen.unknown[k] < 1 || (simple && simple->at(x, y))) continue;
            const int left = x / piece_px * piece_px, top = y / piece_px * piece_px;
            const auto wants = [&](const FieldViews& set) {
                return set.picture == number && (!set.wanted || set.wanted(left, top, piece_px, piece_px));
            };
            if (std::any_of(sets.begin(), sets.end(), wants))
                found = true;
            else
                x = left + piece_px - 1;
        }
    });
    return found;
}

/// Returns number `n`, from 1, of the additional rays of each view in `views`, without their pixel.
std::vector<SightLine> lines_of(const Aperture& aperture, const FocusGeometry& geometry,
                                const FieldViews& views, int n) {
    // Each set of lens points has its own number. The numbers of the views' sets are below `stride`, and
    // those of sets for a prediction (predicted_error.h) are far higher.
    constexpr int stride = 1024;
    const int set = views.set + n * stride;
    // The set of a ray seeds its random numbers, together with its pixel. A hash keeps those of different
    // sets apart for every size of the image.
    const auto seed = static_cast<std::uint32_t>(mix64(static_cast<std::uint64_t>(set)));
    std::vector<SightLine> out;
    for (const LensViewPoint& point : lens_view_points(aperture, geometry, views.count, set, views.first)) {
        out.push_back(
            {.place = point.place,
             .lens = point.lens,
             .light_before = point.light_before,
             .set = seed,
             .view = static_cast<std::uint32_t>(views.first) + static_cast<std::uint32_t>(out.size())});
    }
    return out;
}

/// Returns the largest number of additional rays of a pixel in the squares of `piece_px` px in which a set is
/// drawn. `window` contains the pixels of the image.
int most_extra_rays(const BrightEdges& edges, const FieldViews& set, const RasterWindow& window,
                    int piece_px) {
    int most = 0;
    for (int y = 0; y < window.height(); y += piece_px) {
        for (int x = 0; x < window.width(); x += piece_px) {
            const int width = std::min(piece_px, window.width() - x),
                      height = std::min(piece_px, window.height() - y);
            if (set.wanted && !set.wanted(x, y, width, height)) continue;
            const int left = window.x_begin + x, top = window.y_begin + y;
            most = std::max(most, edges.most_in({left, left + width, top, top + height}));
        }
    }
    return most;
}

FieldFocus finished(PatchPicture seen, const std::optional<OneSurface>& simple, bool fill) {
    FieldFocus out{std::move(seen), {}};
    const auto width = static_cast<std::size_t>(out.image.width);
    if (simple) {
        out.left_out.resize(out.unknown.size());
        for (std::size_t k = 0; k < out.left_out.size(); ++k) {
            const bool left = simple->at(static_cast<int>(k % width), static_cast<int>(k / width));
            out.left_out[k] = left ? 1 : 0;
            if (left) out.unknown[k] = 0;
        }
    }
    if (!fill) return out;
    std::vector<float> known(out.unknown.size());
    for (std::size_t k = 0; k < known.size(); ++k) known[k] = 1 - out.unknown[k];
    fill_gaps(out.image, known);
    return out;
}

}  // namespace

struct FieldFocuser::Prepared {
    std::optional<Motions> motions;
    bool moves = false;
    PatchLens lens;
    HighlightRule rule;
    LightElsewhere less;       ///< radiance of the highlights, which rays leave out
    BrightEdges bright_edges;  ///< empty without rays
    std::optional<HighlightMotion> highlight_motion;
    [[nodiscard]] const HighlightMotion* moving() const {
        return highlight_motion ? &*highlight_motion : nullptr;
    }
    std::vector<double> instants_s;
    double strip_records = 0;                 ///< largest number of records of a strip
    std::optional<FieldSurfaces> all;         ///< absent if surfaces are read strip by strip
    std::unique_ptr<FieldHighlights> of_all;  ///< null if highlights are computed for each strip
};

FieldFocuser::~FieldFocuser() = default;

FieldFocuser::FieldFocuser(FocusFrame& frame, FieldFocusSettings settings)
    : frame_(frame), settings_(std::move(settings)), prepared_(std::make_unique<Prepared>()) {
    const SampleFileReader& file = frame.file();
    const FocusGeometry& g = settings_.geometry;
    Prepared& p = *prepared_;
    p.lens = patch_lens(g);
    if (settings_.shutter) p.motions.emplace(*settings_.shutter);
    p.moves = p.motions && p.motions->any();
    // If a mirror image and its mirror differ in their motion by at most follow_px, in px, over the lens, the
    // mirror image is drawn as if it were painted on the mirror. A negative value means never. This is
    // necessary if objects move, because motion could separate the two.
    if (p.moves) p.lens.follow_px = -1;
    const std::size_t instants = p.moves || settings_.shutter ? file.instants() : 1;
    if (instants == 1) p.rule = highlight_rule(settings_.aperture, g);
    if (p.rule.takes && p.moves) {
        p.highlight_motion.emplace([&p](std::uint32_t id) { return p.motions->moves(id); },
                                   [this](std::uint32_t id, double u) {
                                       return settings_.shutter->motion->map(
                                           id, prepared_->instants_s.front(), instant_s(u));
                                   },
                                   p.lens);
        p.rule.takes = [takes = p.rule.takes, &p](const Highlight& light, const SheetKey& key,
                                                  const BrightSheet& sheet) {
            if (p.highlight_motion->moves(key)) return HighlightMotion::takes(light, sheet.area_px2);
            return !p.motions->moves(key.path.bits() == 0 ? key.id : key.parent_id) &&
                   takes(light, key, sheet);
        };
    }
    double records = 0;
    for (std::size_t i = 0; i < instants; ++i) {
        p.instants_s.push_back(file.instant_s(i));
        for (const ScanlineFacts& facts : file.scanlines(i)) records += facts.records;
    }
    const auto most_bytes = static_cast<double>(settings_.surface_bytes);
    double bytes_of_record = 0;
    if (!frame.many() && records * most_surface_bytes_of_record > most_bytes)
        bytes_of_record = surface_bytes_of_record(file, p.lens, p.rule);
    if (records * bytes_of_record > most_bytes) {
        // Highlights are bright light that blur kernels spread, and that traced rays must leave out. To find
        // this light, all surfaces are needed at once, but here they do not fit into memory. So if rays are
        // traced, no highlights are selected: `takes` becomes null.
        if (settings_.rays != nullptr) p.rule.takes = nullptr;
        p.strip_records = most_bytes / 4 / bytes_of_record;
        if (settings_.also.rows || settings_.also.leaves) {
            frame.visit_rows(file.y_begin(), file.y_end(), [&](const FrameRows& rows) {
                tell(settings_.also, *rows.band, rows.y_begin, rows.y_end);
            });
        }
        return;
    }
    p.all.emplace();
    p.bright_edges = BrightEdges({file.x_begin(), file.x_end(), file.y_begin(), file.y_end()});
    for (std::size_t i = 0; i < instants; ++i) {
        const std::shared_ptr<TreeSheets> sheets =
            frame.sheets(i, p.rule, i == 0 ? settings_.also : RecordsRead{});
        if (settings_.rays != nullptr && p.rule.takes) {
            p.less = leave_to_lens(*sheets, *settings_.rays, p.lens, p.moves, p.rule);
            if (!p.moves) p.bright_edges.add(*sheets, p.rule, p.lens);
        }
        p.all->add(sheets, p.lens);
    }
    p.bright_edges.limit();
    p.of_all = std::make_unique<FieldHighlights>(*p.all->sheets[0], settings_.aperture, g, settings_.window,
                                                 p.moving());
}

/// Returns the light field without surfaces and views.
PatchField FieldFocuser::outline() const {
    const Prepared& p = *prepared_;
    PatchField field;
    field.x = settings_.window.x_begin;
    field.y = settings_.window.y_begin;
    field.width = settings_.window.width();
    field.height = settings_.window.height();
    field.piece_px = settings_.piece_px;
    const SampleFileReader& file = frame_.file();
    field.recorded_begin = {file.x_begin(), file.y_begin()};
    field.recorded_end = {file.x_end() - 1, file.y_end() - 1};  // the last row and column have only corners
    if (p.moves) field.motion_class = [&p](std::uint32_t id) { return p.motions->class_of(id); };
    return field;
}

double FieldFocuser::instant_s(double u) const {
    const FieldShutter& s = *settings_.shutter;
    return s.open_s + s.curve.time(u) * (s.close_s - s.open_s);
}

std::vector<PatchView> FieldFocuser::views_at(std::span<const LensViewPoint> points) const {
    const Prepared& p = *prepared_;
    std::vector<PatchView> out;
    for (const LensViewPoint& point : points) {
        PatchView v;
        v.sample = point.place;
        v.lens = point.shift;
        v.lens_point = point.lens;
        v.light_before = point.light_before;
        v.passes = passing(settings_, point);
        v.uses = {{0, 1, {}}};
        if (settings_.shutter && (p.moves || p.instants_s.size() > 1)) {
            v.uses = uses_at(p.instants_s, instant_s(point.light_before), *p.motions);
            if (!p.moves) {
                for (auto& use : v.uses) use.motions.clear();
            }
        }
        out.push_back(std::move(v));
    }
    return out;
}

FieldFocus FieldFocuser::draw(const FieldViews& views) const {
    return std::move(draw(std::span(&views, 1)).front());
}

std::vector<FieldFocus> FieldFocuser::draw(std::span<const FieldViews> sets,
                                           std::vector<FieldFocus> reuse) const {
    const Prepared& p = *prepared_;
    const FocusGeometry& g = settings_.geometry;
    const RasterWindow& window = settings_.window;
    const glm::dvec2 lens_box_px = g.gain_px * g.aperture_radius_m * settings_.aperture.half_extent();
    std::vector<std::vector<LensViewPoint>> points;
    PatchField field = outline();
    std::size_t pictures = 0;
    for (const FieldViews& set : sets) {
        points.push_back(lens_view_points(settings_.aperture, g, set.count, set.set, set.first));
        PatchViews views;
        views.views = views_at(points.back());
        for (std::size_t i = 0; i < views.views.size(); ++i) {
            views.views[i].set = static_cast<std::uint32_t>(set.set);
            views.views[i].number = static_cast<std::uint32_t>(set.first) + static_cast<std::uint32_t>(i);
        }
        views.rays = settings_.rays;
        views.less = p.less;
        views.left_to_rays = set.left_to_rays;
        if (p.bright_edges.most() > 0) {
            views.extra_rays = [&edges = p.bright_edges, &window](int x, int y) {
                return edges.rays(window.x_begin + x, window.y_begin + y);
            };
            const int most = most_extra_rays(p.bright_edges, set, window, settings_.piece_px);
            for (int n = 1; n <= most; ++n)
                views.extra_lines.push_back(lines_of(settings_.aperture, g, set, n));
        }
        views.checked = set.checked;
        views.aimed = set.aimed;
        views.picture = set.picture;
        field.sets.push_back(std::move(views));
        pictures = std::max(pictures, set.picture + 1);
    }
    std::optional<FieldStrips> strips;
    if (!p.all) {
        // The image is drawn in groups of rows, and only the surfaces that may appear in a group are read for
        // it. Some may hide a highlight from a lens point that no view uses. Therefore, the surfaces are
        // chosen with the extent of the whole lens.
        field.lens_reach_px = lens_box_px;
        strips.emplace(frame_.file(), p.instants_s.size(), p.lens, p.rule, field, lens_box_px, p.moving());
    }
    const auto instants_of = [&](const std::vector<LensViewPoint>& of_set) {
        std::vector<double> out;
        for (std::size_t i = 0; p.moves && i < of_set.size(); ++i) out.push_back(of_set[i].light_before);
        return out;
    };
    const std::optional<OneSurface> simple = one_surface(sets, strips ? &*strips : nullptr);
    std::vector<PatchPicture> seen;
    seen.reserve(pictures);
    for (std::size_t i = 0; i < pictures; ++i) {
        if (i < reuse.size() && !reuse[i].image.rgb.empty()) {
            seen.push_back(std::move(reuse[i]));
            seen.back().clear();
        } else {
            seen.emplace_back(window.width(), window.height());
        }
    }
    const auto draw_part = [&](const FieldSurfaces& surfaces, const FieldHighlights& highlights,
                               const Crop& part) {
        surfaces.show(field);
        field.lens_reach_px = highlights.any() || settings_.rays != nullptr ? lens_box_px : glm::dvec2(0);
        std::vector<std::unique_ptr<Lights>> lights;
        for (std::size_t i = 0; i < sets.size(); ++i) {
            if (highlights.any())
                lights.push_back(highlights.over(points[i], sets[i].set, instants_of(points[i])));
            field.sets[i].lights = highlights.any() ? lights.back().get() : nullptr;
            field.sets[i].wanted = [&, i](int x, int y, int width, int height) {
                return part.meets(x / SeenTile::edge * SeenTile::edge, y / SeenTile::edge * SeenTile::edge,
                                  SeenTile::edge, SeenTile::edge) &&
                       !(simple && simple->all(x, y, width, height)) &&
                       (!sets[i].wanted || sets[i].wanted(x, y, width, height));
            };
        }
        patch_field(field, seen);
    };
    const auto draw_crop = [&](const Crop& crop) {
        if (p.all) {
            draw_part(*p.all, *p.of_all, crop);
            return;
        }
        for (const auto& [first, last] : strips->strips(window, p.strip_records)) {
            const int top = std::max(crop.y, first - window.y_begin),
                      end = std::min(crop.y + crop.height, last - window.y_begin);
            if (top >= end) continue;
            const FieldSurfaces surfaces = strips->read(first, last);
            const FieldHighlights highlights(*surfaces.sheets[0], settings_.aperture, g, window, p.moving());
            draw_part(surfaces, highlights, {crop.x, top, crop.width, end - top});
        }
    };
    const Crop whole{0, 0, window.width(), window.height()};
    const Crop crop = settings_.crop.value_or(whole);
    draw_crop(crop);
    std::vector<bool> fills;
    for (std::size_t i = 0; i < seen.size(); ++i)
        fills.push_back(has_gaps(seen[i], i, sets, settings_.piece_px, simple, crop));
    if (settings_.crop && std::find(fills.begin(), fills.end(), true) != fills.end()) draw_crop(whole);
    std::vector<FieldFocus> out;
    out.reserve(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
        out.push_back(finished(std::move(seen[i]), simple, fills[i]));
    return out;
}

std::optional<OneSurface> FieldFocuser::one_surface(std::span<const FieldViews> sets,
                                                    FieldStrips* strips) const {
    const Prepared& p = *prepared_;
    const FocusGeometry& g = settings_.geometry;
    if (!sets.front().leave_out_from_share || settings_.rays != nullptr || p.moves ||
        p.instants_s.size() != 1)
        return std::nullopt;
    const glm::dvec2 lens_box_px = g.gain_px * g.aperture_radius_m * settings_.aperture.half_extent();
    OneSurfaceFinder finder(lens_box_px, g.inverse_focus_per_m, settings_.window);
    if (p.all) {
        finder.add(p.all->primary[0], p.all->deeper[0]);
    } else {
        strips->visit(
            0, [&](const PatchMesh& primary, const PatchMesh& deeper) { finder.add(primary, deeper); });
    }
    OneSurface found = finder.found();
    if (found.share() < *sets.front().leave_out_from_share) return std::nullopt;
    return found;
}

FieldFocus field_focus(FocusFrame& frame, const FieldFocusSettings& settings) {
    return FieldFocuser(frame, settings)
        .draw({.count = settings.views, .leave_out_from_share = settings.leave_out_from_share});
}

}  // namespace postlens
