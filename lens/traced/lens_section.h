// Computes the outlines of a lens, and rays through it, for a drawing.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lens/traced/traced_lens.h"

namespace postlens {

/// A section of a lens along its axis. Points (z, y) are in mm; z begins at the first vertex and points to
/// the film.
struct LensSection {
    struct RayLine {
        std::size_t field = 0;  ///< index into the parameter `fields`
        std::vector<glm::dvec2> points;
    };
    std::vector<std::vector<glm::dvec2>>
        glass;  ///< closed outlines of the elements; the last point is not repeated
    std::vector<std::vector<glm::dvec2>> planes;  ///< surfaces that do not bound glass
    std::vector<std::vector<glm::dvec2>> stop;    ///< the two edges of the stop's opening
    std::vector<RayLine> rays;                    ///< rays that pass the lens, from front to film
    double film_z_mm = 0;
    double front_z_mm = 0;  ///< z at which rays begin
    double height_mm = 0;   ///< largest distance of these curves from the axis
};

/// Computes the cross section of a lens with rays through it, `rays` from each object point at the depth
/// depth_m. `fields` contains the tangent of each object point's angle from the axis. Surfaces for which no
/// clear radius is known are drawn as wide as the rays need.
[[nodiscard]] LensSection lens_section(const Prescription& lens, const TracedLens& traced, double depth_m,
                                       const std::vector<double>& fields, int rays);

}  // namespace postlens
