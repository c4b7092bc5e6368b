#include "motionblur/motion_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

#include "core/text.h"
#include "core/threads.h"
#include "records/motion/motion_path.h"
#include "reproject/instants_around.h"

namespace postlens {
namespace {

using glm::dvec3;

// Number of instants at which shadows and lights are tested: the frame's time, and 18 instants that divide
// the exposure into 17 equal steps. 17 is prime. So even a motion that repeats up to 16 times during the
// exposure is tested in 17 different phases.
constexpr int shadow_instants = 1 + 18;
constexpr int shadow_step_px = 4;

bool is_moving(const std::vector<std::uint32_t>& moving, std::uint32_t id) {
    return std::binary_search(moving.begin(), moving.end(), id);
}

/// Returns whether the surface at `r` reflects or transmits an object that moves differently from this
/// surface. The records from `r` + 1 to `end` are the objects that are seen in the surface. `moving` lists
/// the ids of all moving objects, sorted.
bool shows_other_motion(const Record* r, const Record* end, const std::vector<std::uint32_t>& moving) {
    const bool carried = is_moving(moving, r->id);
    for (const Record* node = r + 1; node != end; ++node) {
        if (is_moving(moving, node->id) ? (!carried || node->id != r->id) : carried) return true;
    }
    return false;
}

/// Calls tree(first, end) for each recorded eye ray of a pixel. The records [first, end) are the surfaces
/// that this ray and its reflections and refractions hit. Surfaces hidden from the pinhole (layers above 0)
/// are left out.
template <typename OnTree>
void for_each_tree(const RecordBand& band, std::size_t pixel, const OnTree& tree) {
    const Record* r = band.records.data() + band.offsets[pixel];
    const Record* end = band.records.data() + band.offsets[pixel + 1];
    while (r != end && r->layer == 0) {
        const Record* next = r + 1;
        while (next != end && next->layer == 0 && next->path.bits() != 0) ++next;
        tree(r, next);
        r = next;
    }
}

/// Counts the pixels for which `concerned` is true, in rows [y_begin, y_end). Only every `step`th pixel along
/// each axis is tested.
template <typename Concerned>
std::uint64_t count_pixels(const SampleHeader& h, const RecordBand& band, int y_begin, int y_end, int step,
                           const Concerned& concerned) {
    const int first = std::max(0, y_begin), last = std::min(h.height, y_end);
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(std::max(last - first, 0)), 0);
    parallel_for(counts.size(), [&](std::size_t row) {
        const int y = first + static_cast<int>(row);
        for (int x = 0; y % step == 0 && x < h.width; x += step) {
            if (concerned(band, band.pixel(x, y))) ++counts[row];
        }
    });
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

double share_of(std::uint64_t pixels, const SampleHeader& h, int step) {
    const int across = (h.width + step - 1) / step, down = (h.height + step - 1) / step;
    return static_cast<double>(pixels) / (static_cast<double>(across) * down);
}

struct MovingSphere {
    std::uint32_t id = 0;
    std::array<dvec3, shadow_instants> centre{};
    std::array<glm::dmat3, shadow_instants> rotation{};
    double radius = 0;
};

struct MovingLight {
    bool directional = false, casts_shadows = true;
    std::array<dvec3, shadow_instants> place{};
};

double instant(const SampleHeader& h, const Exposure& e, int i) {
    return i == 0 ? h.time_s : e.open_s + (e.close_s - e.open_s) * (i - 1) / (shadow_instants - 2);
}

/// Returns whether something moves during the exposure, or between it and the frame's instant.
bool moves(const MotionPath& path, const SampleHeader& h, const Exposure& e) {
    return path.moves(std::min(e.open_s, h.time_s), std::max(e.close_s, h.time_s));
}

std::vector<MovingSphere> spheres_of(const SampleHeader& h, const Exposure& exposure) {
    std::vector<MovingSphere> out;
    for (const auto& [id, object] : h.motion.objects) {
        const MotionPath path(object.keys);
        if (!moves(path, h, exposure)) continue;
        MovingSphere s{id, {}, {}, 0};
        for (std::size_t i = 0; i < shadow_instants; ++i) {
            const MotionPath::Pose pose = path.at(instant(h, exposure, static_cast<int>(i)));
            s.centre[i] = pose.point(object.centre_m);
            s.rotation[i] = pose.rotation;
            const dvec3 scale = glm::abs(pose.scale);
            s.radius = std::max(s.radius, object.radius_m * std::max({scale.x, scale.y, scale.z}));
        }
        out.push_back(s);
    }
    return out;
}

std::vector<MovingLight> lights_of(const SampleHeader& h, const Exposure& exposure) {
    std::vector<MovingLight> out;
    for (const LightMotion& light : h.motion.lights) {
        MovingLight l{light.directional, light.casts_shadows, {}};
        const MotionPath path(light.keys);
        for (int i = 0; i < shadow_instants; ++i) {
            const MotionPath::Pose pose = path.at(instant(h, exposure, i));
            l.place[static_cast<std::size_t>(i)] =
                light.directional ? -pose.direction(light.place) : pose.point(light.place);
        }
        out.push_back(l);
    }
    return out;
}

/// Returns whether the line from point p to the light intersects the sphere at instant i.
bool crosses(const dvec3& p, const MovingLight& light, const MovingSphere& sphere, std::size_t i) {
    const dvec3 way = light.directional ? light.place[i] : light.place[i] - p;
    const dvec3 to = sphere.centre[i] - p;
    const double length2 = glm::dot(way, way);
    double along = length2 > 0 ? std::max(0.0, glm::dot(to, way) / length2) : 0;
    if (!light.directional) along = std::min(along, 1.0);
    const dvec3 off = to - along * way;
    return glm::dot(off, off) < sphere.radius * sphere.radius;
}

/// Returns the direction from an object to the light at instant i, in the object's frame.
dvec3 direction_to(const MovingLight& light, const MovingSphere& object, std::size_t i) {
    const dvec3 way = light.directional ? light.place[i] : light.place[i] - object.centre[i];
    return way * object.rotation[i];  // the transpose of the rotation times `way`
}

/// Returns whether an object's shading changes visibly, because it moves relative to a light.
bool is_relit(const MovingSphere& object, const std::vector<MovingLight>& lights) {
    constexpr double least_degrees = 15;
    for (const MovingLight& light : lights) {
        const dvec3 recorded = direction_to(light, object, 0);
        for (std::size_t i = 1; i < shadow_instants; ++i) {
            const dvec3 d = direction_to(light, object, i);
            const double angle = std::atan2(glm::length(glm::cross(recorded, d)), glm::dot(recorded, d));
            if (glm::degrees(angle) > least_degrees) return true;
        }
    }
    return false;
}

class ShadowTest {
  public:
    ShadowTest(const SampleHeader& h, const Exposure& exposure)
        : is_perspective_(h.projection == Projection::perspective),
          world_from_raster_(h.world_from_camera * camera_from_raster(h)),
          spheres_(spheres_of(h, exposure)),
          lights_(lights_of(h, exposure)) {
        for (const MovingSphere& s : spheres_) {
            if (is_relit(s, lights_)) relit_.push_back(s.id);
        }
        lit_objects_move_ = !spheres_.empty() && !lights_.empty();
        std::erase_if(lights_, [](const MovingLight& l) { return !l.casts_shadows; });
    }

    [[nodiscard]] bool possible() const { return !spheres_.empty() && !lights_.empty(); }
    [[nodiscard]] bool lit_objects_move() const { return lit_objects_move_; }
    /// Sorted ids of objects whose shading changes, because they move relative to a light.
    [[nodiscard]] const std::vector<std::uint32_t>& relit() const { return relit_; }
    [[nodiscard]] bool operator()(const Record& r) const {
        if (r.id == 0 || std::isinf(r.z)) return false;
        const dvec3 p = world(r);
        for (const MovingSphere& sphere : spheres_) {
            if (sphere.id == r.id) continue;  // an object's shadow on itself moves with it
            for (const MovingLight& light : lights_) {
                for (std::size_t i = 0; i < shadow_instants; ++i) {
                    if (crosses(p, light, sphere, i)) return true;
                }
            }
        }
        return false;
    }

  private:
    [[nodiscard]] dvec3 world(const Record& r) const {
        const auto x = static_cast<double>(r.x), y = static_cast<double>(r.y), z = static_cast<double>(r.z);
        const double scale = is_perspective_ ? z : 1;
        return {world_from_raster_ * glm::dvec4(scale * x, scale * y, z, 1)};
    }

    bool is_perspective_;
    glm::dmat4 world_from_raster_;
    std::vector<MovingSphere> spheres_;
    std::vector<MovingLight> lights_;  ///< lights that cast shadows
    std::vector<std::uint32_t> relit_;
    bool lit_objects_move_ = false;
};

/// Returns true if the motion moves an unrecorded part of an object, which lies outside the recorded area,
/// into the image. `e` is the bounding box of the recorded part. `map` moves points from their recorded
/// position to their position at another instant.
bool border_is_within(const SampleFileReader& file, const RasterMap& map, const IdExtent& e) {
    const SampleHeader& h = file.header();
    const std::array<bool, 4> cut{e.x_min <= file.x_begin(), e.x_max >= file.x_end() - 1,
                                  e.y_min <= file.y_begin(), e.y_max >= file.y_end() - 1};
    if (std::find(cut.begin(), cut.end(), true) == cut.end()) return false;
    for (int k = 0; k < 8; ++k) {
        const bool right = (k & 1) != 0, low = (k & 2) != 0;
        const auto p = map({right ? e.x_max : e.x_min, low ? e.y_max : e.y_min,
                            (k & 4) != 0 ? e.inverse_z_max : e.inverse_z_min});
        if (!p) return true;
        constexpr double margin_px = 0.5;
        if ((cut[0] && !right && p->x > margin_px) || (cut[1] && right && p->x < h.width - margin_px) ||
            (cut[2] && !low && p->y > margin_px) || (cut[3] && low && p->y < h.height - margin_px))
            return true;
    }
    return false;
}

}  // namespace

struct UnseenMotion::Counts {
    Counts(const SampleHeader& of, std::vector<std::uint32_t> sorted, const Exposure& exposure)
        : header(of),
          moving(std::move(sorted)),
          shadow(of, exposure),
          lights_move(
              std::any_of(of.motion.lights.begin(), of.motion.lights.end(), [&](const LightMotion& light) {
                  return postlens::moves(MotionPath(light.keys), of, exposure);
              })) {}

    const SampleHeader& header;
    std::vector<std::uint32_t> moving;
    ShadowTest shadow;
    bool lights_move;
    std::uint64_t reflections = 0, shadows = 0, lit = 0;  ///< pixels
};

UnseenMotion::UnseenMotion(const SampleHeader& header, std::vector<std::uint32_t> moving,
                           const Exposure& exposure)
    : counts_(std::make_unique<Counts>(header, std::move(moving), exposure)) {}

UnseenMotion::~UnseenMotion() = default;

bool UnseenMotion::possible() const {
    const Counts& c = *counts_;
    return (c.header.has_w && !c.moving.empty()) || c.shadow.lit_objects_move() || c.lights_move;
}

void UnseenMotion::add(const RecordBand& band, int y_begin, int y_end) {
    Counts& c = *counts_;
    if (c.header.has_w && !c.moving.empty()) {
        c.reflections +=
            count_pixels(c.header, band, y_begin, y_end, 1, [&](const RecordBand& b, std::size_t pixel) {
                bool found = false;
                for_each_tree(b, pixel, [&](const Record* r, const Record* end) {
                    found = found || shows_other_motion(r, end, c.moving);
                });
                return found;
            });
    }
    if (c.shadow.possible()) {
        c.shadows += count_pixels(
            c.header, band, y_begin, y_end, shadow_step_px, [&](const RecordBand& b, std::size_t pixel) {
                return b.offsets[pixel] < b.offsets[pixel + 1] && c.shadow(b.records[b.offsets[pixel]]);
            });
    }
    const std::vector<std::uint32_t>& relit = c.shadow.relit();
    if (c.lights_move || !relit.empty()) {
        c.lit += count_pixels(c.header, band, y_begin, y_end, 1, [&](const RecordBand& b, std::size_t pixel) {
            if (b.offsets[pixel] == b.offsets[pixel + 1]) return false;
            const std::uint32_t id = b.records[b.offsets[pixel]].id;
            return id != 0 && (c.lights_move || std::binary_search(relit.begin(), relit.end(), id));
        });
    }
}

std::vector<MotionWarning> UnseenMotion::warnings() const {
    const Counts& c = *counts_;
    std::vector<MotionWarning> out;
    if (c.reflections > 0) {
        const double share = share_of(c.reflections, c.header, 1);
        out.push_back({"reflection", share,
                       fmt::format("mirrors and glass show what moves otherwise than they do in {:.2f} % of "
                                   "the pixels; where they show it is recorded for one instant only "
                                   "(expected `trace --keys` or `render` for it)",
                                   100 * share)});
    }
    if (c.shadows > 0) {
        const double share = share_of(c.shadows, c.header, shadow_step_px);
        out.push_back({"shadow", share,
                       fmt::format("shadows of moving objects may pass over up to {} % of the pixels; "
                                   "they stay where they were recorded (expected `trace --keys` or `render` "
                                   "for them)",
                                   rough(100 * share))});
    }
    if (c.lights_move || c.lit > 0) {
        const double share = share_of(c.lit, c.header, 1);
        out.push_back({"light", share,
                       fmt::format("{}: shading is that of {} s in {} % of the pixels (expected "
                                   "`trace --keys` or `render` for it)",
                                   c.lights_move ? "lights move" : "objects turn or pass by lights",
                                   c.header.time_s, rough(100 * share))});
    }
    return out;
}

void warn_of_gaps(const std::vector<float>& unknown, const char* text, std::vector<MotionWarning>& out) {
    constexpr float noticeable = 0.01F;
    const auto gaps = std::count_if(unknown.begin(), unknown.end(), [](float u) { return u > noticeable; });
    if (gaps == 0) return;
    const double share = static_cast<double>(gaps) / static_cast<double>(unknown.size());
    out.push_back({"uncovered", share, fmt::format(fmt::runtime(text), 100 * share)});
}

bool is_cut(const SampleFileReader& file, const FrameMotion& motion, std::uint32_t id,
            std::span<const IdExtents> instants, const Exposure& exposure) {
    const bool in_frame = instants[0].contains(id);
    std::vector<double> instants_s;
    for (std::size_t i = 0; i < instants.size(); ++i) instants_s.push_back(file.instant_s(i));
    for (const double t : probe_times(motion.breaks_s(id), exposure)) {
        const auto is_whole = [&](std::size_t instant) {
            const auto found = instants[instant].find(id);
            return found != instants[instant].end() &&
                   !border_is_within(file, motion.map(id, instants_s[instant], t), found->second);
        };
        if (is_whole(0)) continue;
        const std::vector<InstantShare> around = instants_around(instants_s, t);
        // Skips the time t if the object is not visible then. The image at the time t is made from the
        // recorded instants before and after t (`around`), so the object is not visible if it is recorded at
        // neither of them.
        const auto shows = [&](const InstantShare& at) { return instants[at.instant].contains(id); };
        if (!in_frame && std::none_of(around.begin(), around.end(), shows)) continue;
        if (std::none_of(around.begin(), around.end(),
                         [&](const InstantShare& at) { return is_whole(at.instant); }))
            return true;
    }
    return false;
}

void warn_of_cut(const SampleFileReader& file, const FrameMotion& motion,
                 const std::vector<ObjectReport>& objects, std::span<const IdExtents> instants,
                 const Exposure& exposure, std::vector<MotionWarning>& out) {
    const bool camera_moves = motion.camera_moves(exposure.open_s, exposure.close_s);
    std::string names;
    bool others_help = false;  // whether lightfield would use more recorded instants than were used
    for (const ObjectReport& o : objects) {
        if (o.id == 0 || o.kind == MotionKind::still) continue;
        const bool by_field = o.method == MotionMethod::lightfield;
        // If the camera moves, objects that are blurred by the method lightfield (`by_field`) are left out.
        // Then even static objects move in the image, so almost every object at the border of the recorded
        // area would be named. For the method lightfield, the warning "uncovered" reports missing surfaces.
        if (camera_moves && by_field) continue;
        const std::size_t used = by_field ? instants.size() : 1;
        if (!is_cut(file, motion, o.id, instants.first(used), exposure)) continue;
        names += (names.empty() ? "" : ", ") + label_of(file.header(), o.id);
        others_help = others_help || used < instants.size();
    }
    if (names.empty()) return;
    const std::string cure = others_help           ? "--method lightfield or auto, which use all keys"
                             : instants.size() > 1 ? "a trace with more --keys or overscan, or --scene"
                                                   : "`trace --overscan auto --for-shutter --keys auto`";
    out.push_back(
        {"overscan", 0,
         fmt::format("moving objects are cut by the border of the records: {} (expected {})", names, cure)});
}

}  // namespace postlens
