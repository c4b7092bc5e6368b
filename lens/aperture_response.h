// The geometric impulse response of an aperture of any shape, on the pixel grid.
#pragma once

#include "lens/aperture.h"
#include "lens/response_grid.h"

namespace postlens {

/// Maps a lens point q to the position where its light lands on the film: `map_px q + spherical_px q |q|^2`,
/// px, relative to `centre_px`. For scene points nearer than the plane in focus, map_px also turns the
/// aperture upside down and left to right.
struct ApertureImage {
    glm::dmat2 map_px{1};
    double spherical_px = 0;
    glm::dvec2 field{0};      ///< position in the field, see Aperture
    double rim_scale = 1;     ///< of the second rim, see Aperture
    glm::dvec2 centre_px{0};  ///< relative to the anchor
};

/// Pixels [x_begin, x_end) x [y_begin, y_end), relative to the anchor.
struct PixelWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Smallest half width of the aperture's image, px. A thinner image is widened to this, because an area of 0
/// has no pixel coverage.
inline constexpr double smallest_response_px = 1e-4;
[[nodiscard]] glm::dmat2 with_area(const glm::dmat2& map_px);

/// True if the response is a uniformly lit outline, so that image_outline() describes it completely.
[[nodiscard]] bool is_even(const Aperture& aperture, const ApertureImage& image);
/// Outline of the aperture's image, px, as a polygon within 1e-3 px of the curve (0.02 px with cats_eye).
/// Empty if no light passes.
[[nodiscard]] Outline image_outline(const Aperture& aperture, const ApertureImage& image);

/// Largest distance from the response's centre at which it has light, px.
[[nodiscard]] double largest_reach_px(const Aperture& aperture, const ApertureImage& image);

/// Largest distance, px, from the image of a point at which light of the point arrives. `radius_px`: signed
/// radius of the circle of confusion; `spherical_px`: as in ApertureImage. Unlike largest_reach_px, it is not
/// larger than necessary where the aberration counteracts the defocus.
[[nodiscard]] double farthest_light_px(const Aperture& aperture, double radius_px, double spherical_px);

/// The response of any aperture within a window. Over the whole plane, its values add up to 1 (0 if no light
/// passes). The aperture is divided into cells: the pixels of an aperture image, or rings and sectors whose
/// images deviate from polygons by less than 0.02 px. The light of each cell is spread uniformly over the
/// cell's image. Where the images of cells overlap, as in caustics, their light adds up.
[[nodiscard]] ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image,
                                          const PixelWindow& window);

/// Reference for tests: counts the rays of a grid of `points` x `points` lens points that land in each pixel.
[[nodiscard]] ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image,
                                        const PixelWindow& window, int points);

}  // namespace postlens
