#include "tracer/distributed/scene_rays.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

constexpr std::size_t group_size = 16;

}  // namespace

SceneRays::SceneRays(const RenderSetup& setup, const DistributedSettings& settings, int lines,
                     std::uint64_t seed)
    : setup_(setup), sampler_(SamplerKind::sobol, lines, seed), tracer_(setup.rays(), sampler_, settings) {
    const Scene& scene = setup.rays().scene();
    const bool sampled =
        std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) { return l.has_extent(); });
    for (const Object& o : scene.objects) {
        const Material& m = scene.materials[o.material];
        // Adds the object to `unsteady_` if the radiance that a single ray returns for it is noisy. There is
        // noise if the material has a glossy lobe, or if it is lit by area lights, because rays choose
        // directions in the lobe and points of the lights at random. Such a ray cannot be compared with the
        // mean radiance that the sample file stores.
        if (m.has_lobe() || (sampled && m.answers_lights())) unsteady_.insert(o.id);
        if (m.has_lobe()) steady_mirrors_ = false;
    }
}

bool SceneRays::steady(NodePath path, std::uint32_t id) const {
    return (path.bits() == 0 || steady_mirrors_) && !unsteady_.contains(id);
}

namespace {

void store(const EyeRays& eye, const std::vector<glm::dvec3>& from,
           std::span<std::array<float, 3>> radiance) {
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        const double weight = eye.weight.empty() ? 1.0 : static_cast<double>(eye.weight[i]);
        for (int c = 0; c < 3; ++c)
            radiance[i][static_cast<std::size_t>(c)] = static_cast<float>(weight * from[i][c]);
    }
}

}  // namespace

void SceneRays::trace(std::span<const SightLine> lines, const LightElsewhere& less,
                      std::span<std::array<float, 3>> radiance) const {
    thread_local EyeRays eye;
    trace(lines, less, eye);
    store(eye, eye.radiance, radiance);
}

void SceneRays::trace_elsewhere(std::span<const SightLine> lines, std::span<const NodeIdentity> of,
                                const LightElsewhere& less, std::span<std::array<float, 3>> radiance) const {
    std::fill(radiance.begin(), radiance.end(), std::array<float, 3>{});
    if (!less.of) return;
    thread_local EyeRays eye;
    eye.left_out_of.assign(of.begin(), of.end());
    trace(lines, less, eye);
    store(eye, eye.left_out, radiance);
}

void SceneRays::inverse_depths(std::span<const SightLine> lines, std::uint32_t id,
                               std::span<glm::dvec3> inverse_z) const {
    thread_local EyeRays eye;
    aim(lines, eye);
    const RayScene& scene = setup_.rays();
    scene.intersect(eye.rays, tracer_.coherent());
    const RayBatch& b = eye.rays;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        inverse_z[i] = glm::dvec3(0);
        if (!b.hit(i).valid()) continue;
        const glm::dvec3 origin(b.ox[i], b.oy[i], b.oz[i]), direction(b.dx[i], b.dy[i], b.dz[i]);
        const SurfacePoint s = scene.surface(b.hit(i), origin, direction, static_cast<double>(b.t[i]), 0);
        if (scene.scene().objects[s.object].id != id) continue;
        inverse_z[i] = setup_.camera().inverse_depth(s.position, s.geometric_normal);
    }
}

void SceneRays::aim(std::span<const SightLine> lines, EyeRays& eye) const {
    eye.rays.clear(false, tracer_.needs_times());
    eye.pixel.clear();
    eye.index.clear();
    eye.weight.clear();
    LensCamera::PointSamples samples;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled lane by lane
    const int width = setup_.width();
    const auto pixels = static_cast<std::uint32_t>(width) * static_cast<std::uint32_t>(setup_.height());
    for (std::size_t first = 0; first < lines.size(); first += group_size) {
        const std::size_t count = std::min(group_size, lines.size() - first);
        for (std::size_t i = 0; i < group_size; ++i) {
            // The camera makes rays in groups of 16, one for each element of `lines`. The last group may have
            // only `count` elements. Then the last element is repeated until there are 16 rays, and these
            // additional rays are removed from `eye.rays` below.
            const SightLine& line = lines[first + std::min(i, count - 1)];
            samples.x[i] = static_cast<float>(line.x + line.place.x);
            samples.y[i] = static_cast<float>(line.y + line.place.y);
            samples.lens[i] = line.lens;
            samples.time[i] = static_cast<float>(line.light_before);
            if (i >= count) continue;
            eye.pixel.push_back(static_cast<std::uint32_t>(line.y * width + line.x) + line.set * pixels);
            eye.index.push_back(static_cast<int>(line.view));
        }
        setup_.camera().add_rays(samples, eye.rays, eye.weight);
        eye.rays.count -= static_cast<int>(group_size - count);
    }
}

void SceneRays::trace(std::span<const SightLine> lines, const LightElsewhere& less, EyeRays& eye) const {
    aim(lines, eye);
    eye.less = less.of ? &less : nullptr;
    eye.recorded_at = [&](std::size_t ray, double t) {
        const SightLine& line = lines[ray];
        return setup_.camera().pinhole_px(line.x + line.place.x, line.y + line.place.y, line.lens, t);
    };
    RayCounts counts;
    tracer_.trace(eye, counts);
    const std::lock_guard lock(mutex_);
    counts_ += counts;
}

RayCounts SceneRays::counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
}

}  // namespace postlens
