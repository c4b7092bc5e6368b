#include "focus/field_focus.h"

#include <cmath>

#include "focus/field_highlights.h"
#include "focus/lens_views.h"
#include "reproject/fill_gaps.h"
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

}  // namespace

FieldFocus field_focus(const SampleFileReader& file, const FieldFocusSettings& settings) {
    const FocusGeometry& g = settings.geometry;
    const PatchLens lens{g.gain_px * g.aperture_radius_m, g.inverse_focus_per_m};
    const TreeSheets sheets = tree_sheets(file, 0, highlight_rule(settings.aperture, g));
    const PatchMesh primary = cut_patches(sheets.primary, lens), deeper = cut_patches(sheets.deeper, lens);
    PatchField field;
    field.x = settings.window.x_begin;
    field.y = settings.window.y_begin;
    field.width = settings.window.width();
    field.height = settings.window.height();
    field.instants = {{&primary, deeper.patches.empty() ? nullptr : &deeper}};
    const std::vector<LensViewPoint> points = lens_view_points(settings.aperture, g, settings.views);
    const FieldHighlights highlights(sheets, settings.aperture, g, points, settings.window);
    if (highlights.any()) field.lights = &highlights;
    for (const LensViewPoint& p : points) {
        PatchView v;
        v.sample = p.place;
        v.uses = {{0, 1, {}}};
        v.lens = p.shift;
        v.passes = passing(settings, p);
        field.views.push_back(std::move(v));
    }
    PatchPicture seen = patch_field(field);
    FieldFocus out;
    std::vector<float> known(seen.unknown.size());
    for (std::size_t k = 0; k < known.size(); ++k) {
        known[k] = 1 - seen.unknown[k];
        out.unknown_share += static_cast<double>(seen.unknown[k]) / static_cast<double>(known.size());
    }
    fill_gaps(seen.image, known);
    out.image = std::move(seen.image);
    return out;
}

}  // namespace postlens
