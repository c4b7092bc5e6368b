// The geometric impulse response of any aperture, on the pixel grid.
#pragma once

#include "lens/aperture.h"
#include "lens/response_grid.h"

namespace postlens {

/// Maps a lens point q to the position on the film where its light arrives: `map_px q + spherical_px q
/// |q|^2`, px, relative to `centre_px`. In front of the focus, map_px inverts the aperture.
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

/// Smallest half width of the aperture's image, px; a thinner image is widened to it so that it has an area.
inline constexpr double smallest_response_px = 1e-4;
[[nodiscard]] glm::dmat2 with_area(const glm::dmat2& map_px);

/// True if the response is the uniformly lit image of an outline, which then describes it completely.
[[nodiscard]] bool is_even(const Aperture& aperture, const ApertureImage& image);
/// Outline of the aperture's image, px, with chords within 1e-3 px (0.02 px with cats_eye); empty if no light
/// passes.
[[nodiscard]] Outline image_outline(const Aperture& aperture, const ApertureImage& image);

/// Largest distance of a point of the response from its centre, px.
[[nodiscard]] double largest_reach_px(const Aperture& aperture, const ApertureImage& image);

/// The response of any aperture within a window. Without the window its values add up to 1 (0 if no light
/// passes). The aperture is divided into cells, whose light is spread uniformly over their images: the pixels
/// of an aperture image, or rings and sectors so small that their images deviate by less than 0.02 px. Where
/// images overlap, as in caustics, they add up.
[[nodiscard]] ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image,
                                          const PixelWindow& window);

/// Reference for tests: counts `points`^2 rays through the aperture per pixel.
[[nodiscard]] ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image,
                                        const PixelWindow& window, int points);

}  // namespace postlens
