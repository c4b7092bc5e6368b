#include "chart/point_picture.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "focus/focus.h"
#include "motionblur/motion_blur.h"
#include "motionblur/paths/paths_file.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "tracer/render.h"

namespace postlens {
namespace {

constexpr std::uint64_t points_seed = 2;

}  // namespace

Image PointPictures::picture(const PlannedPoint& p, const std::filesystem::path& path, double& retraced,
                             std::vector<std::string>& warnings) const {
    using Kind = PlannedPoint::Kind;
    if (p.kind == Kind::rays) {
        RenderSettings s = render_settings(request_, view_);
        s.spp = p.amount;
        s.seed = points_seed;
        return render_picture(scene_, s).image;
    }
    const SampleFileReader file(path);
    if (p.kind == Kind::motionblur) {
        MotionBlurSettings s{.exposure = {view_.shutter->open_s, view_.shutter->close_s}, .method = p.motion};
        if (p.amount > 0) s.views = p.amount;
        MotionBlurResult r = motion_blur(file, s);
        for (const MotionWarning& w : r.warnings) warnings.push_back(w.code);
        return std::move(r.image);
    }
    FocusFrame frame(file);
    return focused(p, frame, view_.lens, retraced, warnings);
}

Image PointPictures::focused(const PlannedPoint& p, FocusFrame& frame, const ThinLens& lens, double& retraced,
                             std::vector<std::string>& warnings) const {
    using Kind = PlannedPoint::Kind;
    FocusSettings f{.lens = lens, .focus_distance_m = view_.focus_m, .method = p.focus};
    if (p.focus == FocusMethod::scatter && p.amount > 0) f.depths = p.amount;
    if ((p.focus == FocusMethod::lightfield || p.focus == FocusMethod::hybrid) && p.amount > 0)
        f.views = p.amount;
    if (p.kind == Kind::focus && p.focus != FocusMethod::hybrid) {
        if (p.focus == FocusMethod::pinhole) f.lens.f_number = std::numeric_limits<double>::infinity();
        FocusResult r = focus_picture(frame, f);
        for (const FocusWarning& w : r.warnings) warnings.push_back(w.code);
        return std::move(r.image);
    }
    HybridSettings h{.focus = f};
    std::optional<FrameMotion> motion;
    if (view_.shutter) {
        motion = motion_of(frame.file().header(), {});
        h.motion = &*motion;
        h.shutter = view_.shutter;
    }
    if (p.focus == FocusMethod::hybrid) h.scene = &scene_;
    HybridResult r = hybrid_picture(frame, h);
    retraced = r.retraced_share;
    for (const FocusWarning& w : r.focus.warnings) warnings.push_back(w.code);
    return std::move(r.focus.image);
}

}  // namespace postlens
