#include "motionblur/vector_blur.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "motionblur/motion_warnings.h"
#include "motionblur/shutter_views.h"
#include "motionblur/vector_mesh.h"
#include "records/crop.h"
#include "reproject/fill_gaps.h"
#include "reproject/light_field.h"

namespace postlens {
namespace {

/// Where less than so much of the picture stands still, what is still is no model of what is behind.
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

LightField views_of(const VectorFrame& frame, const SampleMesh& mesh, const VectorBlurSettings& s,
                    int views) {
    LightField field;
    field.meshes = {&mesh};
    field.width = frame.width;
    field.height = frame.height;
    field.crop = s.crop;
    field.motion_classes = 2;
    field.motion_class = [](std::uint32_t id) { return std::size_t{id}; };
    field.class_marks = {0, 1};
    for (const ShutterView& view : shutter_views(s.curve, s.exposure, views)) {
        FieldView v;
        v.sample = view.place;
        FieldView::Use use;
        use.elapsed = view.time_s;
        v.uses.push_back(std::move(use));
        field.views.push_back(std::move(v));
    }
    return field;
}

/// By pixel: 1 where the picture stands still; nothing where next to nothing does.
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

/// Colours for what nothing is known of: from what stands still, or, where next to nothing does, from what
/// the views do know there and around.
Image filled(std::vector<float> weight, const Image& picture, const FieldPicture& seen) {
    Image out = picture;
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
    const SampleMesh mesh = vector_mesh(frame);
    LightField views = views_of(frame, mesh, settings, result.views);
    FieldPicture seen = light_field(views);
    Image behind;
    if (std::any_of(seen.unknown.begin(), seen.unknown.end(), [](float u) { return u > 0; })) {
        const std::vector<float> still = what_stands_still(frame);
        if (still.empty() && views.crop) {
            // Gaps are then filled from all that the views know.
            views.crop.reset();
            seen = light_field(views);
        }
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
