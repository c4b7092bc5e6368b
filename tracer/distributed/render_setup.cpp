#include "tracer/distributed/render_setup.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tracer/distributed/recentre.h"
#include "tracer/trace.h"

namespace postlens {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Value that is used as the f-number of a lens prescription (a real lens) until its own f-number has been
/// computed. Any finite value would do, but an infinite f-number would mean a pinhole.
constexpr double wide_open = 1;

void check(const RenderSettings& s) {
    if (s.spp < 1 || s.spp > Sampler::max_spp) {
        fail(ExitCode::wrong_arguments, "--spp: out of range (got {}; expected 1 to {})", s.spp,
             Sampler::max_spp);
    }
    if (s.halves && s.spp % 2 != 0) {
        fail(ExitCode::wrong_arguments,
             "--spp: cannot be halved (got {}; expected an even number with --halves)", s.spp);
    }
    check_tracing(s.tracing.max_depth, s.tracing.min_contribution, s.time_s);
    if (s.shutter) check_shutter("--shutter", *s.shutter);
}

}  // namespace

RenderSetup::RenderSetup(const Scene& scene, const RenderSettings& settings) {
    check(settings);
    const double time_s = settings.time_s.value_or(scene.time_s);
    span_ = settings.shutter.value_or(TimeSpan{time_s, time_s});
    const Camera& asked = find_camera(scene, settings.camera_name);
    const CameraModel far(asked, span_.open_s, settings.camera);
    scene_ = recentred(scene, far.position);
    const Camera& of = find_camera(scene_, asked.name);
    const CameraModel model(of, span_.open_s, settings.camera);
    resolve_lens(settings, of, model,
                 settings.time_s.value_or(settings.shutter ? span_.open_s : scene.time_s));
    camera_.emplace(of, model,
                    LensCamera::Settings{geometry_, span_, settings.curve, settings.aperture, view_});
    const MotionAccuracy accuracy{
        [this](const glm::dvec3& world, double at) { return camera_->px_per_m(world, at); }};
    rays_.emplace(scene_, span_, accuracy);
}

void RenderSetup::resolve_lens(const RenderSettings& s, const Camera& camera, const CameraModel& model,
                               double time_s) {
    lens_.focal_length_mm = s.focal_length_mm.value_or(
        model.projection == Camera::Projection::perspective ? model.film_distance_mm : 50);
    if (model.projection == Camera::Projection::orthographic) {
        // An orthographic camera has neither a film distance nor an aperture.
        if (s.f_number && std::isfinite(*s.f_number)) {
            fail(ExitCode::wrong_arguments,
                 "--f-number: out of range for an orthographic camera, which has no lens (got {}; expected "
                 "inf)",
                 *s.f_number);
        }
        if (s.prescription) {
            fail(ExitCode::wrong_arguments,
                 "--impulse: out of range for an orthographic camera, which has no lens (got lens:{}; "
                 "expected "
                 "nothing)",
                 s.prescription->file);
        }
        if (s.framing != Framing::keep) {
            fail(ExitCode::wrong_arguments,
                 "--framing: out of range for an orthographic camera, which has no film distance (expected "
                 "keep)");
        }
        lens_.f_number = focus_m_ = infinity;
        return;
    }
    lens_.f_number = s.f_number.value_or(s.prescription ? wide_open : camera.f_number.value_or(infinity));
    const std::optional<double> focus = s.focus_m ? s.focus_m : camera.focus_m;
    if (s.focus_at) {
        const CameraModel then(camera, time_s, s.camera);
        const auto [x, y] = *s.focus_at;
        if (!(x >= 0 && y >= 0 && x <= model.width && y <= model.height)) {
            fail(ExitCode::wrong_arguments,
                 "--focus-at: outside the picture (got {},{}; expected 0..{},0..{})", x, y, model.width,
                 model.height);
        }
        focus_m_ = depth_at(s.focus_at->first, s.focus_at->second, then, time_s);
    } else if (focus) {
        focus_m_ = *focus;
    } else if (std::isfinite(lens_.f_number) || s.framing == Framing::breathing) {
        fail(ExitCode::wrong_arguments,
             "--focus: missing (got nothing; expected a value, as the scene names none)");
    } else {
        focus_m_ = infinity;  // a pinhole needs no focus distance
    }
    if (s.prescription) {
        look_through(s, model);
    } else {
        geometry_ =
            focus_geometry(lens_, focus_m_, s.framing, {model.film_distance_mm, model.pixel_pitch_mm});
    }
}

void RenderSetup::look_through(const RenderSettings& s, const CameraModel& model) {
    if (s.focal_length_mm) {
        fail(ExitCode::wrong_arguments,
             "--focal-length: not with a real lens (got {} mm; expected nothing, as {} has its own)",
             *s.focal_length_mm, s.prescription->file);
    }
    view_ = std::make_shared<LensView>(
        *s.prescription, LensViewSettings{.focus_distance_m = focus_m_,
                                          .f_number = s.f_number,
                                          .framing = s.framing,
                                          .film = {model.film_distance_mm, model.pixel_pitch_mm},
                                          .half_diagonal_px = std::hypot(model.width, model.height) / 2.0});
    geometry_ = view_->geometry();
    lens_ = {view_->lens().first_order().efl_mm, view_->lens().f_number()};
}

double RenderSetup::depth_at(double x, double y, const CameraModel& model, double time_s) const {
    const RayScene still(scene_, time_s);
    const CameraRay ray = model.ray(x, y);
    RayBatch one;
    one.clear(false);
    one.add(ray.origin, ray.direction, std::numeric_limits<float>::infinity());
    still.intersect(one, false);
    if (!one.hit(0).valid()) return infinity;
    return still.surface(one.hit(0), ray.origin, ray.direction, static_cast<double>(one.t[0])).t *
           ray.cos_axis;
}

std::string RenderSetup::fingerprint(const RenderSettings& s) const {
    const auto exact = [](double v) {
        return fmt::format("{}", v);
    };  // the shortest text from which the same number is read
    const nlohmann::ordered_json json = {
        {"scene", scene_.sha256},
        {"metres_per_unit", exact(scene_.metres_per_unit)},
        {"lumens_per_watt", exact(scene_.lumens_per_watt.value_or(0))},
        {"exposure_stops", exact(scene_.exposure_stops)},
        {"camera", s.camera_name},
        {"size", {width(), height()}},
        {"film_width_mm", s.camera.film_width_mm ? exact(*s.camera.film_width_mm) : ""},
        {"focal_length_mm", exact(lens_.focal_length_mm)},
        {"f_number", exact(lens_.f_number)},
        {"focus_m", exact(focus_m_)},
        {"gain_px", exact(geometry_.gain_px)},
        {"aperture", s.aperture ? s.aperture->fingerprint() : 0},
        {"prescription", s.prescription ? postlens::fingerprint(*s.prescription) : 0},
        {"shutter_s", {exact(span_.open_s), exact(span_.close_s)}},
        {"curve", s.curve.fingerprint()},
        {"sampler", static_cast<int>(s.sampler)},
        {"spp", s.spp},
        {"seed", s.seed},
        {"halves", s.halves},
        {"max_depth", s.tracing.max_depth},
        {"min_contribution", exact(s.tracing.min_contribution)}};
    return json.dump();
}

}  // namespace postlens
