// A real lens set to a focus distance and an f-number: rays between film and scene, and what a point of the
// scene becomes on the film.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "lens/prescription/first_order.h"
#include "lens/prescription/lens_stack.h"
#include "lens/prescription/prescription.h"

namespace postlens {

enum class FocusCriterion {
    paraxial,  ///< the image of rays close to the axis is on the film
    rms_spot,  ///< the axial spot, wide open as set, has the smallest root mean square radius
};
enum class FocusMove {
    film,  ///< the lens stands still
    lens,  ///< the film stands where it is for infinity; the lens moves towards the scene as a whole
};

struct TracedLensSettings {
    /// s > 0, from the pinhole (see TracedLens); infinity allowed. Absent: the film stays where the
    /// prescription has it, or at the focus for infinity.
    std::optional<double> focus_distance_m;
    std::optional<double> f_number;       ///< finite, not below what the lens opens to; absent: wide open
    std::optional<double> wavelength_nm;  ///< absent: the prescription's
    FocusCriterion criterion = FocusCriterion::paraxial;
    FocusMove move = FocusMove::film;
    double film_radius_mm = 21.64;  ///< > 0; the farthest film point that scene_ray is asked for
};

/// A ray into the scene.
struct SceneRay {
    glm::dvec3 origin_mm{0};  ///< on the first surface, in the frame of the pinhole
    glm::dvec3 direction{0, 0, -1};
    double weight = 0;  ///< see TracedLens::scene_ray
};

/// Rays of one object point over a grid of the entrance pupil: its impulse response as a mesh. Kept by the
/// caller and filled again and again without allocation once it is large enough.
struct PupilMesh {
    int nodes = 0;                     ///< along each side; node (i, j) is at j * nodes + i
    std::vector<glm::dvec2> pupil_mm;  ///< on the plane of the paraxial entrance pupil
    std::vector<glm::dvec2>
        film_mm;  ///< where it lands, relative to `chief_film_mm`; 0 where it does not pass
    std::vector<std::uint8_t> passes;  ///< 1 or 0
    std::vector<float> weight;         ///< light per area of the pupil's plane, relative to its centre's
    glm::dvec2 chief_film_mm{0};       ///< where the ray through the stop's centre lands; see `has_chief`
    bool has_chief =
        false;  ///< false: that ray does not get to the film; the mean of those that do stands for it
    double passing_area_mm2 = 0;  ///< of the pupil's plane, weighted
};

/// Frame of all rays and points: mm, the origin at the pinhole, which is the centre of the paraxial entrance
/// pupil of the lens focused at infinity; x to the right and y up as seen from behind the camera, z from the
/// scene towards the film, so that the camera looks along -z. The image is upside down: film point (x, y)
/// sees what lies towards (-x, -y). Depths z' and focus distances are measured from the pinhole along the
/// axis, in metres, as in sample files. Throws Error(wrong_arguments) for settings out of range, for a focus
/// so near that no real image lies behind the lens, Error(invalid_input) for a diverging or telecentric lens,
/// or one through which no ray gets to the film.
class TracedLens {
  public:
    explicit TracedLens(const Prescription& lens, const TracedLensSettings& settings = {});

    [[nodiscard]] const FirstOrder& first_order() const { return first_order_; }
    [[nodiscard]] const LensStack& stack() const { return stack_; }
    [[nodiscard]] const TracedLensSettings& settings() const { return settings_; }
    [[nodiscard]] double f_number() const { return f_number_; }
    [[nodiscard]] double wavelength_nm() const { return wavelength_nm_; }
    /// z of the film in the frame of the pinhole: what a pinhole camera would have as film distance.
    [[nodiscard]] double film_z_mm() const { return film_from_vertex_mm_ - pinhole_from_vertex_mm_; }
    /// From the last surface's vertex to the film.
    [[nodiscard]] double film_distance_mm() const { return film_from_vertex_mm_ - stack_.last_vertex_z_mm(); }
    /// z of the pinhole in the frame of the lens, whose origin is the first vertex.
    [[nodiscard]] double pinhole_from_vertex_mm() const { return pinhole_from_vertex_mm_; }
    /// How far the lens has moved towards the scene: 0 with FocusMove::film.
    [[nodiscard]] double extension_mm() const { return extension_mm_; }

    /// The ray that reaches the film at `film_mm` through a point of the pupil as seen from there. (u, v) in
    /// [0, 1)^2 cover a rectangle of the plane touching the last surface which holds all that gets through to
    /// this film point. Returns false where the ray is lost. The mean over (u, v) of weight times radiance
    /// (lost rays counting 0) is the film's irradiance, divided by what a uniform scene of radiance 1 gives
    /// at the film's centre: weight = n'^2 A cos^4(theta) / Z^2 / E0 [kolb1995, eq. 4], A the rectangle's
    /// area, Z the distance of its plane from the film, theta between ray and axis, n' the index before the
    /// film (radiance grows with its square). Vignetting and the fall-off of light are in it. False beyond
    /// `film_radius_mm`. Costs one trace; no allocation.
    [[nodiscard]] bool scene_ray(glm::dvec2 film_mm, glm::dvec2 uv, SceneRay& out) const noexcept;
    /// E0, sr: irradiance at the film's centre per radiance of a uniform scene; about pi / (4 n^2).
    [[nodiscard]] double axial_irradiance_sr() const { return axial_irradiance_sr_; }

    /// What a point at depth_m > 0 (infinity allowed) towards the tangents `field` = (x/z', y/z') from the
    /// pinhole becomes: nodes^2 rays, 2 <= nodes <= 4096, over a rectangle that holds all that passes. False,
    /// with nothing passing, where no ray gets through.
    bool impulse(double depth_m, glm::dvec2 field, int nodes, PupilMesh& out) const;

    /// The ray from an object point through a point of the entrance pupil's plane, before the first surface,
    /// in the frame of the lens.
    [[nodiscard]] LensRay object_ray(double depth_m, glm::dvec2 field, glm::dvec2 pupil_mm) const noexcept;
    /// The point of the entrance pupil's plane that is aimed at the stop's centre [welford1986, 5]. Empty
    /// where there is none.
    [[nodiscard]] std::optional<glm::dvec2> aim_at_stop(double depth_m, glm::dvec2 field) const noexcept;
    /// Where a ray of the lens's frame, behind the last surface, meets the film.
    [[nodiscard]] glm::dvec2 on_film(const LensRay& ray) const noexcept {
        return ray.at_z(film_from_vertex_mm_);
    }

  private:
    struct Box {
        glm::dvec2 low{0}, high{0};
        [[nodiscard]] bool empty() const { return !(high.x > low.x && high.y > low.y); }
    };
    void set_focus(const Prescription& lens);
    [[nodiscard]] double sharp_film_mm(const Prescription& lens, double distance_from_pupil_m) const;
    void find_rear_boxes();
    [[nodiscard]] Box passing_rear(double film_radius_mm, const Box& from) const;
    [[nodiscard]] Box passing_pupil(double depth_m, glm::dvec2 field, Box from) const;

    TracedLensSettings settings_;
    double wavelength_nm_ = 0;
    FirstOrder first_order_;
    LensStack stack_;
    double f_number_ = 0;
    double film_from_vertex_mm_ = 0, pinhole_from_vertex_mm_ = 0, extension_mm_ = 0;
    double axial_irradiance_sr_ = 1;
    double film_index_squared_ = 1;
    std::vector<Box> rear_boxes_;  ///< by film radius, for film points on the +y axis
};

}  // namespace postlens
