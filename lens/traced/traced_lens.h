// A real lens that is focused and stopped down: its rays between film and scene, and its impulse responses.
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
    rms_spot,  ///< the axial spot has the smallest root mean square radius at the given f-number
};
enum class FocusMove {
    film,  ///< the film moves, and the lens stays
    lens,  ///< the lens moves towards the scene, and the film stays where infinity is in focus
};

struct TracedLensSettings {
    /// Focus distance s > 0, in m, measured from the pinhole of the camera. It may be infinite. If it is
    /// absent, the film is at the position that the prescription states. If the prescription states none, or
    /// if `criterion` is not paraxial, the film is where infinity is in focus.
    std::optional<double> focus_distance_m;
    std::optional<double> f_number;       ///< finite, not below that of the open lens; absent: wide open
    std::optional<double> wavelength_nm;  ///< absent: the prescription's
    FocusCriterion criterion = FocusCriterion::paraxial;
    FocusMove move = FocusMove::film;
    double film_radius_mm = 21.64;  ///< > 0; scene_ray accepts film points up to this radius
};

/// A ray into the scene.
struct SceneRay {
    glm::dvec3 origin_mm{0};  ///< on the first surface, in the frame of the pinhole
    glm::dvec3 direction{0, 0, -1};
    double weight = 0;  ///< see TracedLens::scene_ray
};

/// Rays from one object point through a grid of points in the entrance pupil. Their landing points on the
/// film represent the object point's impulse response. A PupilMesh can be filled several times, and then
/// reuses its memory.
struct PupilMesh {
    int nodes = 0;  ///< rays along each side of the grid; ray (i, j) has the index j * nodes + i
    std::vector<glm::dvec2> pupil_mm;  ///< on the plane of the paraxial entrance pupil
    std::vector<glm::dvec2>
        film_mm;  ///< landing point relative to `chief_film_mm`; 0 if the ray does not pass
    std::vector<std::uint8_t> passes;  ///< 1 or 0
    std::vector<float> weight;         ///< light per area of the pupil plane, relative to its centre
    glm::dvec2 chief_film_mm{0};       ///< landing point of the ray through the centre of the stop
    bool has_chief = false;  ///< false: that ray is blocked, and chief_film_mm is the mean landing point of
                             ///< all passing rays
    double passing_area_mm2 = 0;  ///< weighted area of the pupil plane where rays pass
};

/// A lens for ray tracing. All rays and points are in mm in the frame of the pinhole, which is the centre of
/// the paraxial entrance pupil at infinity focus. Seen from behind the camera, x points right, y up, and z
/// from the scene to the film. The film image is upside down: film point (x, y) sees (-x, -y).
///
/// Depths z' and focus distances are in m, measured from the pinhole along the axis.
///
/// Throws Error(wrong_arguments) if a setting is out of range, or if the focus is too near for a real image.
/// Throws Error(invalid_input) if the lens is diverging or telecentric, or if no ray reaches the film.
class TracedLens {
  public:
    explicit TracedLens(const Prescription& lens, const TracedLensSettings& settings = {});

    [[nodiscard]] const FirstOrder& first_order() const { return first_order_; }
    [[nodiscard]] const LensStack& stack() const { return stack_; }
    [[nodiscard]] const TracedLensSettings& settings() const { return settings_; }
    [[nodiscard]] double f_number() const { return f_number_; }
    [[nodiscard]] double wavelength_nm() const { return wavelength_nm_; }
    /// Returns the distance from the pinhole to the film: z of the film in the frame of the pinhole.
    [[nodiscard]] double film_z_mm() const { return film_from_vertex_mm_ - pinhole_from_vertex_mm_; }
    /// Distance from the last surface's vertex to the film.
    [[nodiscard]] double film_distance_mm() const { return film_from_vertex_mm_ - stack_.last_vertex_z_mm(); }
    /// z of the pinhole, measured from the first surface's vertex.
    [[nodiscard]] double pinhole_from_vertex_mm() const { return pinhole_from_vertex_mm_; }
    /// How far focusing has moved the lens towards the scene. It is 0 if focusing moves the film
    /// (FocusMove::film).
    [[nodiscard]] double extension_mm() const { return extension_mm_; }

    /// Computes the ray that reaches the film at `film_mm`. (u, v) in [0, 1)^2 select its point in a
    /// rectangle that touches the last surface, through which all such rays pass. Returns false if the ray is
    /// blocked, or if the film point is beyond `film_radius_mm`. Does not allocate memory.
    ///
    /// The irradiance of the film point is the mean of weight times radiance over (u, v), relative to the
    /// film centre under a uniform scene (E0). Blocked rays count as 0. For a rectangle of area A at distance
    /// Z from the film, a ray at angle theta, and the refractive index n' there [kolb1995, eq. 4]:
    ///
    ///     weight = n'^2 A cos^4(theta) / Z^2 / E0
    [[nodiscard]] bool scene_ray(glm::dvec2 film_mm, glm::dvec2 uv, SceneRay& out) const noexcept;
    /// Returns E0, in sr: the irradiance at the film centre per radiance of a uniform scene. At f-number n,
    /// it is about pi / (4 n^2).
    [[nodiscard]] double axial_irradiance_sr() const { return axial_irradiance_sr_; }

    /// Traces rays from an object point through the lens. The rays cross the plane of the entrance pupil in a
    /// grid of `nodes`^2 points (2 to 4096 per side) that covers all passing rays. Returns false if no ray
    /// passes.
    ///
    /// The point has the depth z' = depth_m > 0, which may be infinite. Its other coordinates, divided by z',
    /// are `field` = (x/z', y/z').
    bool impulse(double depth_m, glm::dvec2 field, int nodes, PupilMesh& out) const;

    /// Returns the ray from an object point through a point of the entrance pupil's plane, before it enters
    /// the lens.
    [[nodiscard]] LensRay object_ray(double depth_m, glm::dvec2 field, glm::dvec2 pupil_mm) const noexcept;
    /// Finds the chief ray of an object point, which is the ray that passes through the stop's centre
    /// [welford1986, 5]. Returns the point, in mm, at which it crosses the plane of the entrance pupil. The
    /// result is empty if no such ray exists.
    [[nodiscard]] std::optional<glm::dvec2> aim_at_stop(double depth_m, glm::dvec2 field) const noexcept;
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
