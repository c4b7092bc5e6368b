#include "chart/atlas/atlas_picture.h"

#include <algorithm>

#include "chart/atlas/recoloured.h"
#include "focus/bend_warning.h"
#include "focus/focus.h"
#include "motionblur/motion_blur.h"
#include "motionblur/paths/paths_file.h"
#include "planner/hybrid.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t method_seed = 2;  // must differ from the seed of the reference, which is 1

FocusMethod focus_method(const std::string& name) {
    if (name == "scatter") return FocusMethod::scatter;
    if (name == "layers") return FocusMethod::layers;
    if (name == "lightfield") return FocusMethod::lightfield;
    return name == "hybrid" ? FocusMethod::hybrid : FocusMethod::pinhole;
}

class Maker {
  public:
    Maker(const AtlasMethod& method, const ChartRequest& request, const ChartView& view, const Scene& scene,
          const fs::path& path)
        : method_(method), request_(request), view_(view), scene_(scene), path_(path) {}

    AtlasPicture make() {
        if (method_.name == "rays") {
            by_rays();
        } else {
            const SampleFileReader file(path_);
            if (method_.name == "focus-after-shutter") {
                by_both_in_turn(file);
            } else if (view_.shutter && view_.has_lens()) {
                by_hybrid(file, method_.name == "hybrid");
            } else if (view_.shutter) {
                by_shutter(file);
            } else if (method_.name == "hybrid") {
                by_hybrid(file, true);
            } else {
                take(focus_picture(file, focus_settings()));
                if (method_.name != "pinhole" && method_.depth_model == DepthModel::ray_differentials)
                    warn_of_bend(file);
            }
        }
        auto& codes = out_.warnings;
        std::sort(codes.begin(), codes.end());
        codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
        return std::move(out_);
    }

  private:
    [[nodiscard]] FocusSettings focus_settings() const {
        FocusSettings s{.lens = view_.lens,
                        .focus_distance_m = view_.focus_m,
                        .method = focus_method(method_.name),
                        .spacing = method_.spacing,
                        .depth_model = method_.depth_model,
                        .depths = method_.depths};
        if (method_.views) s.views = *method_.views;
        if (method_.name == "pinhole") s.lens.f_number = std::numeric_limits<double>::infinity();
        return s;
    }

    template <typename Result>
    void take(Result r) {
        for (const auto& w : r.warnings) out_.warnings.push_back(w.code);
        out_.image = std::move(r.image);
    }

    void warn_of_bend(const SampleFileReader& file) {
        const SampleHeader& h = file.header();
        const FocusGeometry g =
            focus_geometry(view_.lens, view_.focus_m, Framing::keep, {h.film_distance_mm, h.pixel_pitch_mm});
        FocusFrame frame(file);
        if (const auto w = bend_warning(frame, g)) out_.warnings.push_back(w->code);
    }

    [[nodiscard]] MotionBlurSettings shutter_settings(MotionMethod method) const {
        return {.exposure = {view_.shutter->open_s, view_.shutter->close_s},
                .method = method,
                .views = method_.views};
    }

    void by_rays() {
        RenderSettings s = render_settings(request_, view_);
        s.spp = method_.spp;
        s.seed = method_seed;
        out_.image = render_picture(scene_, s).image;
    }

    void by_shutter(const SampleFileReader& file) {
        const MotionMethod m = method_.name == "convolve"     ? MotionMethod::convolve
                               : method_.name == "lightfield" ? MotionMethod::lightfield
                                                              : MotionMethod::automatic;
        take(motion_blur(file, shutter_settings(m)));
    }

    void by_hybrid(const SampleFileReader& file, bool retraces) {
        HybridSettings s{.focus = focus_settings()};
        std::optional<FrameMotion> motion;
        if (view_.shutter) {
            motion = motion_of(file.header(), {});
            s.motion = &*motion;
            s.shutter = view_.shutter;
        }
        if (retraces) s.scene = &scene_;
        HybridResult r = hybrid_picture(file, s);
        out_.retraced_share = r.retraced_share;
        take(std::move(r.focus));
    }

    void by_both_in_turn(const SampleFileReader& file) {
        take(motion_blur(file, shutter_settings(MotionMethod::lightfield)));
        fs::path recoloured = path_;
        recoloured.replace_extension(".recoloured.exr");
        write_recoloured(file, out_.image, recoloured);
        FocusSettings s = focus_settings();
        s.method = FocusMethod::layers;
        {
            const SampleFileReader blurred(recoloured);
            take(focus_picture(blurred, s));
        }
        fs::remove(recoloured);
    }

    const AtlasMethod& method_;
    const ChartRequest& request_;
    const ChartView& view_;
    const Scene& scene_;
    const fs::path& path_;
    AtlasPicture out_;
};

}  // namespace

TraceSettings atlas_trace_settings(const AtlasTrace& trace, const ChartRequest& request,
                                   const ChartView& view) {
    TraceSettings out = best_trace(request, view);
    if (!trace.for_view) {
        out = TraceSettings{};
        out.camera = request.camera;
        out.camera_name = request.camera_name;
    }
    if (trace.for_f_number) out.for_f_number = trace.for_f_number;
    if (trace.for_focus_m) out.for_focus_m = trace.for_focus_m;
    if (trace.levels) {
        out.subdivide_for_lens = false;
        out.subdivision.levels = *trace.levels;
    }
    if (trace.hidden_layers) out.hidden_layers = trace.hidden_layers;
    if (trace.overscan_px) {
        out.overscan_auto = false;
        out.overscan_px = *trace.overscan_px;
    }
    if (trace.keys) out.keys = trace.keys;
    if (trace.max_depth) out.whitted.max_depth = *trace.max_depth;
    return out;
}

AtlasPicture atlas_picture(const AtlasMethod& method, const ChartRequest& request, const ChartView& view,
                           const Scene& scene, const fs::path& file) {
    return Maker(method, request, view, scene, file).make();
}

}  // namespace postlens
