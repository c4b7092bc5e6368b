// A real lens, set to a focus distance and an f-number. Computes rays between film and scene, and the impulse
// response of a scene point.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "lens/prescription/first_order.h"
#include "lens/prescription/prescription.h"
#include "lens/traced/lens_stack.h"

namespace postlens {

enum class FocusCriterion {
    paraxial,  ///< the paraxial image is on the film
    rms_spot,  ///< the axial spot, at the f-number set, has the smallest root mean square radius
};
enum class FocusMove {
    film,  ///< the film moves, the lens does not
    lens,  ///< the whole lens moves towards the scene, the film stays at its position for infinity
};

struct TracedLensSettings {
    /// Focus distance s > 0, measured from the pinhole (see TracedLens); infinity is allowed. Absent: the
    /// film stays at the distance given by the prescription or, if it gives none, at the focus for infinity.
    std::optional<double> focus_distance_m;
    std::optional<double> f_number;       ///< finite, not below that of the open lens; absent: wide open
    std::optional<double> wavelength_nm;  ///< absent: the prescription's
    FocusCriterion criterion = FocusCriterion::paraxial;
    FocusMove move = FocusMove::film;
    double film_radius_mm = 21.64;  ///< > 0; largest distance of a film point for scene_ray
};

/// A ray into the scene.
struct SceneRay {
    glm::dvec3 origin_mm{0};  ///< on the first surface, in the frame of the pinhole
    glm::dvec3 direction{0, 0, -1};
    double weight = 0;  ///< see TracedLens::scene_ray
};

/// Rays of one object point through a grid of points of the entrance pupil: the impulse response as a mesh.
/// Filling the same mesh again reuses its memory.
struct PupilMesh {
    int nodes = 0;                     ///< along each side; node (i, j) is at j * nodes + i
    std::vector<glm::dvec2> pupil_mm;  ///< on the plane of the paraxial entrance pupil
    std::vector<glm::dvec2>
        film_mm;  ///< landing point relative to `chief_film_mm`; 0 if the ray does not pass
    std::vector<std::uint8_t> passes;  ///< 1 or 0
    std::vector<float> weight;         ///< light per area of the pupil's plane, relative to its centre
    glm::dvec2 chief_film_mm{0};       ///< landing point of the ray through the centre of the stop
    bool has_chief = false;  ///< false: that ray is blocked, and chief_film_mm is the mean landing point of
                             ///< all passing rays
    double passing_area_mm2 = 0;  ///< weighted area of the pupil's plane whose rays pass
};

/// A lens for ray tracing. All rays and points use one frame, in mm. Its origin is the pinhole: the centre of
/// the paraxial entrance pupil when the lens is focused at infinity. Seen from behind the camera, x points to
/// the right and y up; z points from the scene to the film, so the camera looks along -z. The image is upside
/// down: film point (x, y) sees the direction (-x, -y). As in sample files, depths z' and focus distances are
/// in metres, measured from the pinhole along the axis. Throws Error(wrong_arguments) if a setting is out of
/// range, or if the focus is so near that no real image forms behind the lens. Throws Error(invalid_input) if
/// the lens is diverging or telecentric, or if no ray through it reaches the film.
class TracedLens {
  public:
    explicit TracedLens(const Prescription& lens, const TracedLensSettings& settings = {});

    [[nodiscard]] const FirstOrder& first_order() const { return first_order_; }
    [[nodiscard]] const LensStack& stack() const { return stack_; }
    [[nodiscard]] const TracedLensSettings& settings() const { return settings_; }
    [[nodiscard]] double f_number() const { return f_number_; }
    [[nodiscard]] double wavelength_nm() const { return wavelength_nm_; }
    /// z of the film, measured from the pinhole: the film distance of the equivalent pinhole camera.
    [[nodiscard]] double film_z_mm() const { return film_from_vertex_mm_ - pinhole_from_vertex_mm_; }
    /// Distance from the vertex of the last surface to the film.
    [[nodiscard]] double film_distance_mm() const { return film_from_vertex_mm_ - stack_.last_vertex_z_mm(); }
    /// z of the pinhole, measured from the vertex of the lens's first surface.
    [[nodiscard]] double pinhole_from_vertex_mm() const { return pinhole_from_vertex_mm_; }
    /// Distance by which focusing moved the lens towards the scene; 0 with FocusMove::film.
    [[nodiscard]] double extension_mm() const { return extension_mm_; }

    /// Computes the ray that reaches the film at `film_mm` through a point of the pupil. (u, v) in [0, 1)^2
    /// cover a rectangle in the plane that touches the last surface; the rectangle contains all rays that
    /// reach this film point. Returns false if the ray is blocked, or if the film point lies beyond
    /// `film_radius_mm`. The mean over (u, v) of weight times radiance (0 for blocked rays) is the irradiance
    /// of the film point, relative to the irradiance E0 of the film centre under a uniform scene of radiance
    /// 1. weight = n'^2 A cos^4(theta) / Z^2 / E0 [kolb1995, eq. 4], where A is the rectangle's area, Z the
    /// distance of its plane from the film, theta the angle between ray and axis, and n' the refractive index
    /// in front of the film (radiance grows with its square). The weight includes vignetting and the fall-off
    /// of light. Traces one ray, without allocation.
    [[nodiscard]] bool scene_ray(glm::dvec2 film_mm, glm::dvec2 uv, SceneRay& out) const noexcept;
    /// E0, sr: irradiance at the film's centre divided by the radiance of a uniform scene. At f-number n it
    /// is about pi / (4 n^2).
    [[nodiscard]] double axial_irradiance_sr() const { return axial_irradiance_sr_; }

    /// Traces the impulse response of a point at depth_m > 0 (infinity allowed) in the direction `field` =
    /// (x/z', y/z') from the pinhole. The mesh has nodes^2 rays, 2 <= nodes <= 4096, over a rectangle that
    /// contains all passing rays. Returns false if no ray passes.
    bool impulse(double depth_m, glm::dvec2 field, int nodes, PupilMesh& out) const;

    /// Returns the ray from an object point through a point of the entrance pupil's plane, before the first
    /// surface, in the frame of the lens.
    [[nodiscard]] LensRay object_ray(double depth_m, glm::dvec2 field, glm::dvec2 pupil_mm) const noexcept;
    /// Finds the point on the plane of the entrance pupil whose ray passes through the centre of the stop
    /// [welford1986, 5]. Empty if there is no such point.
    [[nodiscard]] std::optional<glm::dvec2> aim_at_stop(double depth_m, glm::dvec2 field) const noexcept;
    /// Returns the intersection with the film of a ray behind the last surface, given in the frame of the
    /// lens.
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
