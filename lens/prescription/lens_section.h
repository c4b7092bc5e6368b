// The outlines of a lens and rays through it, for a drawing.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lens/prescription/traced_lens.h"

namespace postlens {

/// A cut through the axis: points (z, y) in mm, z from the first vertex towards the film.
struct LensSection {
    struct RayLine {
        std::size_t field = 0;  ///< index into the fields asked for
        std::vector<glm::dvec2> points;
    };
    std::vector<std::vector<glm::dvec2>>
        glass;  ///< closed outlines of the elements, the last point not repeated
    std::vector<std::vector<glm::dvec2>> planes;  ///< surfaces that bound no glass
    std::vector<std::vector<glm::dvec2>> stop;    ///< the two sides of its opening
    std::vector<RayLine> rays;                    ///< from in front of the lens to the film; those that pass
    double film_z_mm = 0;
    double front_z_mm = 0;  ///< where rays begin
    double height_mm = 0;   ///< greatest distance from the axis of anything above
};

/// `rays` across the pupil, in the plane of the drawing, for object points at depth_m towards each tangent of
/// `fields`. Surfaces are drawn as wide as they are clear, or as the rays need where nothing is said.
[[nodiscard]] LensSection lens_section(const Prescription& lens, const TracedLens& traced, double depth_m,
                                       const std::vector<double>& fields, int rays);

}  // namespace postlens
