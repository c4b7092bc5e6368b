#include "tracer/intersection/ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "tracer/intersection/ray_scene_impl.h"

namespace postlens {

using glm::dvec3;

void RayBatch::grow() {
    const std::size_t capacity = std::max<std::size_t>(256, ox.size() * 2);
    for (auto* v : {&ox, &oy, &oz, &dx, &dy, &dz, &t_far, &t}) v->resize(capacity);
    source.resize(capacity);
    time.resize(capacity);
    for (auto* v : {&hit_geometry, &hit_primitive, &hit_instance}) v->resize(capacity);
    transmittance.resize(capacity);
}

RayScene::~RayScene() = default;

const Scene& RayScene::scene() const {
    return *impl_->scene;
}

double RayScene::time_s() const {
    return impl_->span.open_s;
}

const TimeSpan& RayScene::span() const {
    return impl_->span;
}

bool RayScene::moves() const {
    return impl_->any_moves;
}

double RayScene::motion_error_px() const {
    return impl_->motion_error_px;
}

void* RayScene::native_handle() const {
    return impl_->top;
}

double RayScene::offset(const dvec3& p) {
    // A ray starts this far from the triangle that it leaves, so that it does not hit adjacent triangles.
    // 2^-18 of the largest coordinate is 64 times the rounding error of a float.
    return 0x1p-18 *
           std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), std::numeric_limits<double>::min()});
}

namespace {

// Copies 16 rays of a batch into an Embree packet. Entries after the end of the batch are disabled.
template <typename Packet>
void load(const RayBatch& rays, std::size_t first, Packet& p, int* valid) {
    constexpr std::size_t n = RayBatch::group;
    const std::size_t left = std::min(n, static_cast<std::size_t>(rays.count) - first);
    const auto copy = [&](float* to, const std::vector<float>& from) {
        // Copies 16 values from index `first` on, even if the batch has fewer rays left. This is safe,
        // because the size of each array is a multiple of 16.
        std::memcpy(to, from.data() + first, n * sizeof(float));
    };
    copy(p.org_x, rays.ox);
    copy(p.org_y, rays.oy);
    copy(p.org_z, rays.oz);
    copy(p.dir_x, rays.dx);
    copy(p.dir_y, rays.dy);
    copy(p.dir_z, rays.dz);
    copy(p.tfar, rays.t_far);
    if (rays.has_times) copy(p.time, rays.time);
    for (std::size_t i = 0; i < n; ++i) {
        p.tnear[i] = 0;
        if (!rays.has_times) p.time[i] = 0;
        p.mask[i] = 0xFFFFFFFFU;
        p.flags[i] = 0;
        p.id[i] = static_cast<unsigned>(first + i);
        // Disables rays that are not finite, because Embree would abort the program. They hit nothing.
        const float most = std::max({std::abs(p.org_x[i]), std::abs(p.org_y[i]), std::abs(p.org_z[i]),
                                     std::abs(p.dir_x[i]), std::abs(p.dir_y[i]), std::abs(p.dir_z[i])});
        const float sum = p.org_x[i] + p.org_y[i] + p.org_z[i] + p.dir_x[i] + p.dir_y[i] + p.dir_z[i];
        valid[i] = i < left && most < 1e18F && sum == sum ? -1 : 0;
    }
}

// Rejects hits at the wrong instance of a moving mesh. Each interval between keyframes has its own Embree
// instance. If the rays of a packet have times in different intervals, Embree 3.13 may report an instance
// that does not exist at the ray's time.
void filter_absent(const RTCFilterFunctionNArguments* args) {
    const auto& context = *reinterpret_cast<const RayContext*>(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
        const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0);
        if (args->valid[i] == 0 || instance == RTC_INVALID_GEOMETRY_ID) continue;
        const Lifetime& life = context.lifetimes[instance];
        const float time = RTCRayN_time(args->ray, args->N, i);
        if (!(time >= life.begin && time < life.end)) args->valid[i] = 0;
    }
    context.log_transmission == nullptr ? filter_source(args) : filter_shadow(args);
}

// Traces the shadow rays of a packet one by one. If Embree traced the packet as a whole, it might report the
// same crossing of a ray and a surface twice. Then the surface's transmittance would be applied twice.
void occlude_singly(RTCRay16& p, const int* valid, RTCScene scene, RayContext& context) {
    for (unsigned i = 0; i < RayBatch::group; ++i) {
        if (valid[i] == 0) continue;
        RTCRay ray{p.org_x[i], p.org_y[i], p.org_z[i], p.tnear[i], p.dir_x[i], p.dir_y[i],
                   p.dir_z[i], p.time[i],  p.tfar[i],  p.mask[i],  p.id[i],    p.flags[i]};
        rtcOccluded1(scene, &context.base, &ray);
        p.tfar[i] = ray.tfar;
    }
}

}  // namespace

void RayScene::intersect(RayBatch& rays, bool coherent) const {
    RayContext context;
    rtcInitIntersectContext(&context.base);
    if (coherent) context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    if (rays.has_sources) {
        context.sources = rays.source.data();
        context.base.filter = filter_source;
    }
    constexpr std::size_t n = RayBatch::group;
    RTCRayHit16 p;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
    alignas(64) std::array<int, n> valid{};
    for (std::size_t first = 0; first < static_cast<std::size_t>(rays.count); first += n) {
        load(rays, first, p.ray, valid.data());
        for (std::size_t i = 0; i < n; ++i) {
            p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid.data(), impl_->top, &context.base, &p);
        // All 16 results are copied, even if fewer rays are left. The arrays in `rays` have room, because
        // their capacity is a multiple of 16.
        std::memcpy(rays.hit_geometry.data() + first, p.hit.geomID, sizeof p.hit.geomID);
        std::memcpy(rays.hit_primitive.data() + first, p.hit.primID, sizeof p.hit.primID);
        std::memcpy(rays.hit_instance.data() + first, p.hit.instID[0], sizeof p.hit.instID[0]);
        std::memcpy(rays.t.data() + first, p.ray.tfar, sizeof p.ray.tfar);
    }
}

void RayScene::occlude(RayBatch& rays) const {
    RayContext context;
    // Rays are not declared coherent: in Embree 3.13, coherent occlusion tests never end if directions in a
    // packet differ in sign.
    rtcInitIntersectContext(&context.base);
    context.shadows = impl_->shadows.data();
    context.object_of_geometry = impl_->object_of_geometry.data();
    if (rays.has_sources) context.sources = rays.source.data();
    if (rays.has_sources || !impl_->all_opaque)
        context.base.filter = impl_->all_opaque ? filter_source : filter_shadow;
    if (impl_->any_cut) {
        context.lifetimes = impl_->lifetimes.data();
        context.base.filter = filter_absent;
    }
    constexpr std::size_t n = RayBatch::group;
    const auto count = static_cast<std::size_t>(rays.count);
    std::vector<std::array<std::int64_t, 3>> logs;
    if (!impl_->all_opaque) {
        logs.assign((count + n - 1) / n * n, {});
        context.log_transmission = logs.data();
    }
    const bool one_by_one = impl_->any_moves && !impl_->all_opaque;
    RTCRay16 p;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
    alignas(64) std::array<int, n> valid{};
    for (std::size_t first = 0; first < count; first += n) {
        load(rays, first, p, valid.data());
        if (one_by_one) {
            occlude_singly(p, valid.data(), impl_->top, context);
        } else {
            rtcOccluded16(valid.data(), impl_->top, &context.base, &p);
        }
        for (std::size_t i = 0; i < n && first + i < count; ++i) {
            dvec3 passed(p.tfar[i] < 0 ? 0.0 : 1.0);
            if (passed.x > 0 && !logs.empty()) {
                const auto& sum = logs[first + i];
                if ((sum[0] | sum[1] | sum[2]) != 0) {
                    passed = {from_fixed_log(sum[0]), from_fixed_log(sum[1]), from_fixed_log(sum[2])};
                }
            }
            rays.transmittance[first + i] = passed;
        }
    }
}

}  // namespace postlens
