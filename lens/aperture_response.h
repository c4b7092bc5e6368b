// Computes the geometric impulse response of an aperture of any shape, on the pixel grid.
#pragma once

#include "lens/aperture.h"
#include "lens/response_grid.h"

namespace postlens {

/// The image of one scene point on the film. Light through lens point q (in lens radii) lands at `map_px q +
/// spherical_px q |q|^2`, in px relative to `centre_px`. For scene points in front of the plane in focus,
/// map_px includes a rotation by 180 degrees.
struct ApertureImage {
    glm::dmat2 map_px{1};
    double spherical_px = 0;
    glm::dvec2 field{0};      ///< position in the field, see Aperture
    double rim_scale = 1;     ///< of the second rim, see Aperture
    glm::dvec2 centre_px{0};  ///< relative to the anchor
};

/// A rectangle of pixels, [x_begin, x_end) x [y_begin, y_end). Coordinates are relative to the anchor, an
/// integer raster position that the caller chooses.
struct PixelWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Smallest half width of the aperture's image, px. with_area() widens a thinner image to this value, because
/// an image without area would cover no pixels.
inline constexpr double smallest_response_px = 1e-4;
[[nodiscard]] glm::dmat2 with_area(const glm::dmat2& map_px);

/// Returns true if the response is uniform inside its outline, so that image_outline() describes it
/// completely.
[[nodiscard]] bool is_even(const Aperture& aperture, const ApertureImage& image);
/// Returns the outline of the aperture's image, in px. The outline is a polygon within 1e-3 px of the true
/// curve, or within 0.02 px if cats_eye (mechanical vignetting) is set. It is empty if no light passes.
[[nodiscard]] Outline image_outline(const Aperture& aperture, const ApertureImage& image);

/// Returns an upper bound of the distance, in px, between `image.centre_px` and the response's farthest
/// light.
[[nodiscard]] double largest_reach_px(const Aperture& aperture, const ApertureImage& image);

/// Returns the distance of the aperture's farthest point from the centre of the lens, in lens radii. Except
/// for aperture images, cats_eye (mechanical vignetting) does not reduce it.
[[nodiscard]] double rim_of(const Aperture& aperture);

/// Returns the largest distance, in px, between the geometric image of a scene point and the light of this
/// point. `radius_px` is the signed radius of the circle of confusion, and `spherical_px` is the spherical
/// aberration as in ApertureImage. The result is exact, whereas largest_reach_px is too large where the
/// aberration counteracts the defocus.
[[nodiscard]] double farthest_light_px(const Aperture& aperture, double radius_px, double spherical_px);

/// Computes the response of any aperture within a window. Over the whole plane, its values add up to 1, or to
/// 0 if no light passes.
///
/// The aperture is divided into cells: the pixels of an aperture image, or else parts of rings. The image of
/// each cell deviates from a polygon by less than 0.02 px. The light of a cell is spread uniformly over the
/// cell's image. Where images of cells overlap, as in caustics, their light adds up.
[[nodiscard]] ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image,
                                          const PixelWindow& window);

/// Reference for tests. Traces a grid of `points` x `points` lens points, and counts the rays that land in
/// each pixel.
[[nodiscard]] ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image,
                                        const PixelWindow& window, int points);

}  // namespace postlens
