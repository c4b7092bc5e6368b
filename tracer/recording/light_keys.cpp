#include "tracer/recording/light_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/threads.h"
#include "pictures/srgb.h"
#include "records/motion/motion_path.h"
#include "reproject/instants_around.h"
#include "tracer/shading_trees/film_motion.h"

namespace postlens {
namespace {

using glm::dvec3;

// Number of equal steps of the shutter interval. At the beginning and the end of each step, the radiance of
// some surface points is measured, to find out how the light changes during the exposure.
constexpr int light_steps = 64;

// Least distance between two recorded instants (keys), in steps of 1/64 of the shutter interval. It is two
// steps: most_light_keys is 33, because recording every second of the 65 instants 0 to 64 makes 33 keys. A
// distance of one step would make 65 keys, but a sample file holds at most 64 (SampleHeader::most_keys).
constexpr int fewest_steps = light_steps / (most_light_keys - 1);

// Number of eye rays along the longer side of the image. Light may change during the exposure, because
// objects or lights move. This change is measured at the surface points that these rays hit, to find how many
// instants must be recorded.
constexpr int longer_side = 80;

/// A point of a surface, without its object's motion.
struct Point {
    std::uint32_t object = 0;
    dvec3 rest{0};
};

/// How the light on one surface point changes: its radiance at each of the tested instants, which are evenly
/// spaced. The last element is for the frame's own instant. An element is empty if the camera does not see
/// the point at this instant.
using History = std::vector<std::optional<dvec3>>;

class LightChange {
  public:
    LightChange(const Scene& scene, const Camera& camera, const CameraOverrides& overrides, double recorded_s,
                const TimeSpan& shutter, const DistributedSettings& tracing)
        : scene_(scene),
          span_{std::min(shutter.open_s, recorded_s), std::max(shutter.close_s, recorded_s)},
          model_(camera, recorded_s, overrides),
          rays_(scene, span_, {[this](const dvec3& world, double) { return px_per_m(world); }}),
          sampler_(SamplerKind::sobol, 1, 0),
          tracer_(rays_, sampler_, tracing) {
        for (int i = 0; i <= light_steps; ++i)
            instants_s_.push_back(even_instant(shutter.open_s, shutter.close_s, i, light_steps + 1));
        instants_s_.push_back(recorded_s);
        for (const double t : instants_s_) cameras_.emplace_back(camera, t, overrides);
        for (const Object& o : scene.objects) paths_.emplace_back(o.keys);
        follow(visible_points());
    }

    /// Returns the predicted PSNR, dB, of an image that is made from only a few recorded instants. The error
    /// arises because the light changes between them. The recorded instants are every `between`-th of the
    /// instants 0 to light_steps, which are evenly spaced over the shutter interval, and the frame's own
    /// instant. If `between` is 0, only the frame's own instant is recorded.
    [[nodiscard]] double psnr_db(int between) const {
        std::vector<std::size_t> keys{instants_s_.size() - 1};
        for (std::size_t i = 0; between > 0 && i <= light_steps; i += static_cast<std::size_t>(between))
            keys.push_back(i);
        std::vector<double> keys_s;
        keys_s.reserve(keys.size());
        for (const std::size_t k : keys) keys_s.push_back(instants_s_[k]);
        std::vector<std::vector<InstantShare>> around;
        for (std::size_t i = 0; i <= light_steps; ++i)
            around.push_back(instants_around(keys_s, instants_s_[i]));
        std::vector<double> squares(histories_.size(), 0);
        parallel_for(squares.size(), [&](std::size_t p) {
            const History& seen = histories_[p];
            dvec3 right(0), shown(0);
            double total = 0;
            for (std::size_t i = 0; i <= light_steps; ++i) {
                dvec3 sum(0);
                double share = 0;
                for (const InstantShare& at : around[i]) {
                    const std::optional<dvec3>& light = seen[keys[at.instant]];
                    if (!light) continue;
                    sum += at.share * *light;
                    share += at.share;
                }
                if (!seen[i] || !(share > 0)) continue;
                const double weight = i == 0 || i == light_steps ? 0.5 : 1;  // the trapezoidal rule
                right += weight * *seen[i];
                shown += weight / share * sum;
                total += weight;
            }
            for (int c = 0; c < 3 && total > 0; ++c) {
                const auto d = static_cast<double>(srgb_from_linear(static_cast<float>(right[c] / total)) -
                                                   srgb_from_linear(static_cast<float>(shown[c] / total)));
                squares[p] += d * d;
            }
        });
        double sum = 0;
        for (const double s : squares) sum += s;
        return -10 * std::log10(sum / (3.0 * static_cast<double>(grid_points_)));
    }

  private:
    [[nodiscard]] double px_per_m(const dvec3& world) const {
        return model_.projection == Camera::Projection::orthographic
                   ? 1000 / model_.pixel_pitch_mm
                   : 1 / (model_.tangent_per_px * glm::distance(world, model_.position));
    }

    [[nodiscard]] float share_of(double time_s) const {
        return static_cast<float>((time_s - span_.open_s) / (span_.close_s - span_.open_s));
    }

    void add(RayBatch& batch, const CameraRay& ray, double time_s) const {
        batch.add(ray.origin, ray.direction, std::numeric_limits<float>::infinity(), {}, share_of(time_s));
    }

    // Returns the surface points that a grid of eye rays hits. Each ray is traced at its own instant of the
    // shutter interval. Neighbouring rays have very different instants, so that the rays also hit surfaces
    // that are in view only briefly.
    [[nodiscard]] std::vector<Point> visible_points() {
        const double px = std::max(model_.width, model_.height) / static_cast<double>(longer_side);
        const int across = std::max(1, static_cast<int>(model_.width / px)),
                  down = std::max(1, static_cast<int>(model_.height / px));
        grid_points_ = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
        constexpr double golden = 0.6180339887498949;
        std::vector<CameraRay> eye;
        std::vector<double> eye_s;
        RayBatch batch;
        batch.clear(false, tracer_.needs_times());
        for (int y = 0; y < down; ++y) {
            for (int x = 0; x < across; ++x) {
                const double turns = golden * static_cast<double>(eye.size());
                const auto i = static_cast<std::size_t>((turns - std::floor(turns)) * (light_steps + 1));
                eye.push_back(cameras_[i].ray((x + 0.5) * px, (y + 0.5) * px));
                eye_s.push_back(instants_s_[i]);
                add(batch, eye.back(), eye_s.back());
            }
        }
        rays_.intersect(batch, false);
        std::vector<Point> out;
        for (std::size_t i = 0; i < eye.size(); ++i) {
            if (!batch.hit(i).valid()) continue;
            const SurfacePoint s =
                rays_.surface(batch.hit(i), eye[i].origin, eye[i].direction, static_cast<double>(batch.t[i]),
                              static_cast<double>(share_of(eye_s[i])));
            const Material& m = scene_.materials[scene_.objects[s.object].material];
            if (!m.answers_lights() && !m.reflects() && m.transmission == dvec3(0)) continue;
            out.push_back({s.object, paths_[s.object].at(eye_s[i]).unmoved_point(s.position)});
        }
        return out;
    }

    void follow(const std::vector<Point>& points) {
        histories_.assign(points.size(), History(instants_s_.size()));
        constexpr std::size_t together = 16;
        parallel_for((points.size() + together - 1) / together, [&](std::size_t chunk) {
            EyeRays eye;
            eye.rays.clear(false, tracer_.needs_times());
            std::vector<std::pair<std::size_t, std::size_t>> of;  // point and instant of every ray
            std::vector<double> distance_m;
            for (std::size_t p = chunk * together; p < std::min((chunk + 1) * together, points.size()); ++p) {
                for (std::size_t i = 0; i < instants_s_.size(); ++i) {
                    const dvec3 at = paths_[points[p].object].at(instants_s_[i]).point(points[p].rest);
                    const auto place = cameras_[i].place(at);
                    if (!place || place->x < 0 || place->y < 0 || place->x > model_.width ||
                        place->y > model_.height)
                        continue;
                    const CameraRay ray = cameras_[i].ray(place->x, place->y);
                    add(eye.rays, ray, instants_s_[i]);
                    eye.pixel.push_back(static_cast<std::uint32_t>(p));
                    eye.index.push_back(0);
                    of.emplace_back(p, i);
                    distance_m.push_back(glm::distance(ray.origin, at));
                }
            }
            RayCounts counts;
            tracer_.trace(eye, counts);
            for (std::size_t k = 0; k < of.size(); ++k) {
                const auto [p, i] = of[k];
                // Relative tolerance for the test whether the camera sees the surface point p. An eye ray
                // towards p must hit the object of p at the distance of p. If the ray hits something nearer,
                // p is hidden. The tolerance is needed because the distance of a hit is computed in single
                // precision.
                constexpr double near = 1e-3;
                if (!eye.rays.hit(k).valid() || rays_.object(eye.rays.hit(k)) != points[p].object ||
                    std::abs(static_cast<double>(eye.rays.t[k]) - distance_m[k]) > near * distance_m[k])
                    continue;
                histories_[p][i] = eye.radiance[k];
            }
        });
    }

    const Scene& scene_;
    TimeSpan span_;
    CameraModel model_;
    RayScene rays_;
    Sampler sampler_;
    DistributedTracer tracer_;
    std::vector<double> instants_s_;  ///< light_steps + 1 in the shutter interval, then the recorded one
    std::vector<CameraModel> cameras_;
    std::vector<MotionPath> paths_;  ///< per object
    std::size_t grid_points_ = 0;
    std::vector<History> histories_;  ///< per point
};

bool light_may_change(const Scene& scene, const Camera& camera, const TimeSpan& span) {
    const auto moves = [&](const auto& of) { return MotionPath(of.keys).moves(span.open_s, span.close_s); };
    const bool any_moves = moves(camera) || std::any_of(scene.lights.begin(), scene.lights.end(), moves) ||
                           std::any_of(scene.objects.begin(), scene.objects.end(), moves);
    return any_moves && (!scene.lights.empty() || has_deeper_nodes(scene));
}

}  // namespace

LightKeys light_keys(const Scene& scene, const Camera& camera, const CameraOverrides& overrides,
                     double recorded_s, const TimeSpan& shutter, double target_db,
                     const DistributedSettings& tracing) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (!light_may_change(scene, camera,
                          {std::min(shutter.open_s, recorded_s), std::max(shutter.close_s, recorded_s)}))
        return {1, infinite};
    const LightChange change(scene, camera, overrides, recorded_s, shutter, tracing);
    // Finds a small number of recorded instants (keys) for which the predicted PSNR of the image is at least
    // `target_db`. Starts with the greatest allowed number, and halves the number until the PSNR would be too
    // low. The search does not start with few keys: there, errors may cancel by chance at the few tested
    // instants, and the search would stop at a number that is too small.
    LightKeys out{most_light_keys, change.psnr_db(fewest_steps)};
    for (int between = 2 * fewest_steps; out.keys > 1; between *= 2) {
        const bool ends = between > light_steps;
        const LightKeys fewer{ends ? 1 : light_steps / between + 1, change.psnr_db(ends ? 0 : between)};
        if (fewer.psnr_db < target_db) break;
        out = fewer;
    }
    return out;
}

}  // namespace postlens
