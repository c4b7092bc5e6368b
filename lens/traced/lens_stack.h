// Traces rays exactly through a lens, surface by surface.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "lens/prescription/prescription.h"

namespace postlens {

enum class RayFate : std::uint8_t {
    passes,
    misses,     ///< does not meet a surface on the side of its vertex
    vignetted,  ///< falls outside a clear radius or outside the opening of the stop
    reflected,  ///< total internal reflection
};

/// The result of tracing a ray through a lens. A ray that does not pass the lens ends at `surface`.
struct RayEnd {
    RayFate fate = RayFate::passes;
    std::size_t surface = 0;  ///< index into the prescription's surfaces
    [[nodiscard]] bool passes() const { return fate == RayFate::passes; }
};

/// A ray in the frame of the lens, in mm. The origin is the first surface's vertex, and z points towards the
/// film.
struct LensRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, 1};  ///< of length 1
    /// Returns where the ray meets the plane at z, perpendicular to the optical axis.
    [[nodiscard]] glm::dvec2 at_z(double z_mm) const {
        return glm::dvec2(origin) + (z_mm - origin.z) / direction.z * glm::dvec2(direction);
    }
};

enum class Apertures : bool { ignored, respected };

/// The surfaces of a lens, prepared for ray tracing. Conics are intersected in closed form, and even aspheres
/// by Newton's method to 1e-10 mm [welford1986, 4].
///
/// Tracing neither allocates nor throws. Many threads may trace at once.
class LensStack {
  public:
    /// Prepares a lens for tracing rays at one wavelength. `lens` must have passed check_prescription.
    /// `stop_radius_mm` is the radius of the opening in the aperture stop. If it is infinite, the stop is
    /// fully open, with the clear radius that `lens` states for the stop's surface.
    LensStack(const Prescription& lens, double wavelength_nm, double stop_radius_mm);

    [[nodiscard]] std::size_t size() const { return elements_.size(); }
    [[nodiscard]] double vertex_z_mm(std::size_t surface) const { return elements_[surface].z; }
    [[nodiscard]] double last_vertex_z_mm() const { return elements_.back().z; }
    [[nodiscard]] double clear_radius_mm(std::size_t surface) const;
    [[nodiscard]] std::size_t stop() const { return stop_; }
    [[nodiscard]] double stop_radius_mm() const { return stop_radius_mm_; }

    /// Traces a ray from the scene to the film. On return, `ray` is the ray behind the last lens surface, or
    /// in front of the surface at which it ends. `hits` is either empty or has size() elements, which receive
    /// the points where the ray meets the surfaces.
    RayEnd forward(LensRay& ray, Apertures apertures = Apertures::respected,
                   std::span<glm::dvec3> hits = {}) const noexcept;
    /// Traces a ray from the film to the scene, like `forward`. direction.z must be negative.
    RayEnd backward(LensRay& ray, Apertures apertures = Apertures::respected,
                    std::span<glm::dvec3> hits = {}) const noexcept;
    /// Traces a ray from the scene to the plane of the stop. Apertures are ignored. Returns the intersection
    /// with the plane, or NaN if the ray does not get there, for example because it misses a surface.
    [[nodiscard]] glm::dvec2 at_stop(LensRay ray) const noexcept;

  private:
    struct Element {
        double z = 0, c = 0, k = 0;
        double forward_ratio = 1, backward_ratio = 1;  ///< n before / n after the surface, and its inverse
        double radius_squared = std::numeric_limits<double>::infinity();
        bool is_asphere = false;
        std::array<double, asphere_terms> asphere{};
    };
    static RayFate meet(const Element& e, LensRay& ray, double sign, Apertures apertures,
                        glm::dvec3& normal) noexcept;
    static bool refract(glm::dvec3& direction, const glm::dvec3& normal, double ratio) noexcept;

    std::vector<Element> elements_;
    std::size_t stop_ = 0;
    double stop_radius_mm_ = 0;
};

}  // namespace postlens
