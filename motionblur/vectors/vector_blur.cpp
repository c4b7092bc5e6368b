#include "motionblur/vectors/vector_blur.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "motionblur/field_blur.h"
#include "motionblur/motion_warnings.h"
#include "motionblur/shutter_views.h"
#include "motionblur/vectors/vector_sheets.h"
#include "pictures/crop.h"
#include "reproject/fill_gaps.h"

namespace postlens {
namespace {

/// Moving pixels may uncover background that the image does not show. If at least this fraction of the pixels
/// is static (does not move), this background is interpolated from the static pixels. Otherwise, there are
/// too few of them.
constexpr double least_still_share = 0.01;

void check(const VectorBlurSettings& s) {
    const Exposure& e = s.exposure;
    constexpr double most_frames = 1000;
    if (!(e.open_s <= e.close_s) || !(std::abs(e.open_s) <= most_frames) ||
        !(std::abs(e.close_s) <= most_frames)) {
        fail(ExitCode::wrong_arguments,
             "--shutter: out of range (got {}:{}; expected frames, OPEN not after CLOSE, within {} of 0)",
             e.open_s, e.close_s, most_frames);
    }
    check_views(s.views);
}

/// Constants for patches, the planar parts into which surfaces are divided. `exact_px` is the largest
/// accepted error, in px, of a patch's position. `overlap_px` is the distance, in px, by which each patch is
/// enlarged on all sides, so that rounding leaves no cracks between patches.
constexpr double exact_px = 0.02, overlap_px = 0.005;
static_assert(overlap_px < 0.5 / most_places);

PatchField views_of(const VectorFrame& frame, const PatchMesh& patches, const VectorBlurSettings& s,
                    int views) {
    PatchField field;
    field.instants = {{&patches, nullptr}};
    field.width = frame.width;
    field.height = frame.height;
    field.motion_class = [](std::uint32_t id) { return std::size_t{id}; };
    field.class_marks = {0, 1};
    PatchViews set;
    for (const ShutterView& view : shutter_views(s.curve, s.exposure, views)) {
        PatchView v;
        v.sample = view.place;
        v.uses = {{0, 1, {}}};
        v.lens.lens_px = {view.time_s, 0};
        set.views.push_back(std::move(v));
    }
    field.sets.push_back(std::move(set));
    return field;
}

/// Returns 1 for static pixels and 0 for others. Returns nothing if static pixels are fewer than
/// `least_still_share`.
std::vector<float> what_stands_still(const VectorFrame& frame) {
    std::vector<float> weight(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height),
                              1);
    std::size_t still = weight.size();
    for (int y = std::max(0, frame.y_begin); y < std::min(frame.height, frame.y_end); ++y) {
        for (int x = std::max(0, frame.x_begin); x < std::min(frame.width, frame.x_end); ++x) {
            const VectorPixel& p = frame.at(x, y);
            if (std::hypot(static_cast<double>(p.right_px), static_cast<double>(p.down_px)) <= still_px)
                continue;
            weight[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) +
                   static_cast<std::size_t>(x)] = 0;
            --still;
        }
    }
    const bool known = static_cast<double>(still) >= least_still_share * static_cast<double>(weight.size());
    return known ? weight : std::vector<float>();
}

/// Returns `picture` with the background behind moving objects, interpolated from the pixels k with weight[k]
/// = 1, which are known to show background.
Image filled(std::vector<float> weight, const Image& picture, const PatchPicture& seen) {
    Image out = picture;
    // Without `weight`, the background is interpolated from pixels of the blurred image `seen`: those that
    // show a surface in at least one of the averaged views (images at single instants).
    if (weight.empty()) {
        weight.resize(seen.unknown.size());
        for (std::size_t k = 0; k < weight.size(); ++k) {
            weight[k] = seen.unknown[k] < 1 ? 1.0F : 0.0F;
            if (seen.touched[k] != 0) std::copy_n(seen.image.rgb.data() + 3 * k, 3, out.rgb.data() + 3 * k);
        }
    }
    fill_gaps(out, weight);
    return out;
}

}  // namespace

MotionBlurResult vector_blur(const VectorFrame& frame, const VectorBlurSettings& settings) {
    check(settings);
    check_crop(settings.crop, frame.width, frame.height);
    MotionBlurResult result;
    result.method = MotionMethod::lightfield;
    result.image = frame.picture();
    const Exposure& e = settings.exposure;
    if (frame.largest_px == 0 || (e.open_s == 0 && e.close_s == 0)) return result;
    result.views = settings.views.value_or(views_for_way(frame.largest_px * (e.close_s - e.open_s)));
    const SheetMesh sheets = vector_sheets(frame);
    PatchLens lens;
    lens.radius_px_m = std::max(std::abs(e.open_s), std::abs(e.close_s));
    lens.exact_px = exact_px;
    lens.overlap_px = overlap_px;
    const PatchMesh patches = cut_patches(sheets, lens);
    PatchField views = views_of(frame, patches, settings, result.views);
    PatchPicture seen = touched_picture(views, settings.crop);
    Image behind;
    if (std::any_of(seen.unknown.begin(), seen.unknown.end(), [](float u) { return u > 0; })) {
        const std::vector<float> still = what_stands_still(frame);
        // The uncovered background is interpolated from static pixels, which are marked in `still`. If there
        // are too few of them, `still` is empty, and the pixels of the blurred image `seen` are used instead.
        // Then the whole image is blurred, because the result must not depend on the crop.
        if (still.empty() && settings.crop) seen = touched_picture(views, std::nullopt);
        behind = filled(still, result.image, seen);
    }
    lay_over(result.image, seen, 0xFF, behind);
    const std::vector<std::uint8_t> marks = cut(seen.touched, frame.width, settings.crop);
    const auto touched =
        std::count_if(marks.begin(), marks.end(), [](std::uint8_t mark) { return mark != 0; });
    result.touched_share = static_cast<double>(touched) / static_cast<double>(marks.size());
    warn_of_gaps(cut(seen.unknown, frame.width, settings.crop),
                 "what comes to light while the shutter is open is not in the picture in {:.2f} % of the "
                 "pixels and is filled from around them",
                 result.warnings);
    return result;
}

}  // namespace postlens
