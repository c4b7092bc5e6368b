// Computes the geometric impulse response of an aperture of any shape.
#pragma once

#include "lens/aperture.h"
#include "lens/response_grid.h"

namespace postlens {

/// Describes the image of one scene point on the film, formed by light through all points of the lens. Light
/// through the lens point q, in lens radii from the lens centre, lands at the following displacement from
/// `centre_px`, in px:
///
///     map_px q + spherical_px q |q|^2
struct ApertureImage {
    /// Describes the defocus. For scene points in front of the focus plane, this matrix includes a rotation
    /// by 180 degrees.
    glm::dmat2 map_px{1};
    /// Displacement of the ray through the lens rim that is caused by spherical aberration, in px.
    double spherical_px = 0;
    glm::dvec2 field{0};      ///< position in the field, see Aperture
    double rim_scale = 1;     ///< of the second rim, see Aperture
    glm::dvec2 centre_px{0};  ///< the point's image, px from the response's raster position
};

/// A rectangle of pixels, [x_begin, x_end) x [y_begin, y_end). Coordinates are relative to the anchor, a
/// raster position that the caller chooses.
struct PixelWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Smallest half width, in px, of a blur kernel's outline. A narrower outline would have almost no area, so
/// the kernel could not be computed. Therefore, with_area changes the matrix that maps the aperture to the
/// outline, so that the outline has this half width.
inline constexpr double smallest_response_px = 1e-4;
[[nodiscard]] glm::dmat2 with_area(const glm::dmat2& map_px);

/// Returns true if the blur kernel has the same value everywhere inside its outline. The outline, which
/// image_outline returns, then describes the whole kernel.
[[nodiscard]] bool is_even(const Aperture& aperture, const ApertureImage& image);
/// Returns the outline of the blur kernel, in px. If no light passes, the outline is empty. Its error is at
/// most 1e-3 px, or 0.02 px with cat's-eye vignetting (cats_eye).
[[nodiscard]] Outline image_outline(const Aperture& aperture, const ApertureImage& image);

/// Returns an upper bound of the blur kernel's radius: the largest distance, in px, from `image.centre_px` to
/// a point that receives light.
[[nodiscard]] double largest_reach_px(const Aperture& aperture, const ApertureImage& image);

/// Returns the distance of the aperture's farthest point from the lens centre, in lens radii. It ignores
/// cat's-eye vignetting.
[[nodiscard]] double rim_of(const Aperture& aperture);

/// Returns the blur kernel's radius, in px: the largest distance from the kernel's centre to a point that
/// receives light. The centre is the point where the ray through the lens centre lands. `radius_px` is the
/// signed radius of the circle of confusion. Unlike largest_reach_px, this is exact with spherical aberration
/// too.
[[nodiscard]] double farthest_light_px(const Aperture& aperture, double radius_px, double spherical_px);

/// Computes the blur kernel of an aperture of any shape, for the pixels in `window`. The light through each
/// cell of the aperture is spread uniformly over the cell's image on the film. The outline of this image has
/// an error below 0.02 px.
///
/// Over the whole plane, the values add up to 1, or to 0 if no light passes.
[[nodiscard]] ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image,
                                          const PixelWindow& window);

/// Reference for tests. Traces `points` x `points` lens points, and counts the rays that land in each pixel.
[[nodiscard]] ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image,
                                        const PixelWindow& window, int points);

}  // namespace postlens
