// Exact rays through a lens, surface by surface.
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
    misses,     ///< has no point in common with a surface, or none on the side of its vertex
    vignetted,  ///< meets a surface outside of its clear radius, or the stop outside of its opening
    reflected,  ///< totally, inside of the glass
};

/// What became of a ray, and at which surface where it did not pass.
struct RayEnd {
    RayFate fate = RayFate::passes;
    std::size_t surface = 0;  ///< index into the prescription's surfaces
    [[nodiscard]] bool passes() const { return fate == RayFate::passes; }
};

/// A line in the frame of the lens: mm, the origin at the first surface's vertex, z towards the film.
struct LensRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, 1};  ///< of length 1
    /// Where it meets a plane across the axis.
    [[nodiscard]] glm::dvec2 at_z(double z_mm) const {
        return glm::dvec2(origin) + (z_mm - origin.z) / direction.z * glm::dvec2(direction);
    }
};

enum class Apertures : bool { ignored, respected };

/// The surfaces of a prescription at one wavelength and one opening of the stop, laid out for tracing.
/// Refraction by Snell's law in vector form; conics are met in closed form, even aspheres by Newton's method
/// to 1e-10 mm [welford1986, 4]. No allocation and no exception per ray; may be used from many threads.
class LensStack {
  public:
    /// `lens` has passed check_prescription. `stop_radius_mm` >= 0; infinity: as the surface has it.
    LensStack(const Prescription& lens, double wavelength_nm, double stop_radius_mm);

    [[nodiscard]] std::size_t size() const { return elements_.size(); }
    [[nodiscard]] double vertex_z_mm(std::size_t surface) const { return elements_[surface].z; }
    [[nodiscard]] double last_vertex_z_mm() const { return elements_.back().z; }
    [[nodiscard]] double clear_radius_mm(std::size_t surface) const;
    [[nodiscard]] std::size_t stop() const { return stop_; }
    [[nodiscard]] double stop_radius_mm() const { return stop_radius_mm_; }

    /// From the scene to the film: `ray` becomes the one that leaves the last surface, or the last one it
    /// was. The ray counts as a line: where on it the origin lies does not matter. `hits`, where not empty,
    /// must hold size() points and gets where the surfaces were met, up to the end's.
    RayEnd forward(LensRay& ray, Apertures apertures = Apertures::respected,
                   std::span<glm::dvec3> hits = {}) const noexcept;
    /// From the film to the scene; direction.z < 0.
    RayEnd backward(LensRay& ray, Apertures apertures = Apertures::respected,
                    std::span<glm::dvec3> hits = {}) const noexcept;
    /// From the scene to the plane of the stop, apertures ignored: where it is met. Not a number where the
    /// ray ends before.
    [[nodiscard]] glm::dvec2 at_stop(LensRay ray) const noexcept;

  private:
    struct Element {
        double z = 0, c = 0, k = 0;
        double forward_ratio = 1, backward_ratio = 1;  ///< index before over after, and back
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
