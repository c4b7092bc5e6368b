// The geometric impulse response of any aperture on the pixel grid.
#pragma once

#include "lens/aperture.h"
#include "lens/response_grid.h"

namespace postlens {

/// Where light through the point q of the aperture arrives: `map_px q + spherical_px q |q|^2`, px from
/// `centre_px`. Before the focus, map_px turns the aperture upside down.
struct ApertureImage {
    glm::dmat2 map_px{1};
    double spherical_px = 0;
    glm::dvec2 field{0};      ///< place of the field, see Aperture
    double rim_scale = 1;     ///< of the second rim, see Aperture
    glm::dvec2 centre_px{0};  ///< relative to the anchor
};

/// Pixels [x_begin, x_end) x [y_begin, y_end), relative to the anchor.
struct PixelWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// A map that is too flat to have an area, px, raised to one of this half width.
inline constexpr double smallest_response_px = 1e-4;
[[nodiscard]] glm::dmat2 with_area(const glm::dmat2& map_px);

/// True where the response is the image of an outline, evenly lit: then that is all there is to know.
[[nodiscard]] bool is_even(const Aperture& aperture, const ApertureImage& image);
/// That outline, px, chords within 1e-3 px, with cats_eye 0.02 px; empty where nothing passes.
[[nodiscard]] Outline image_outline(const Aperture& aperture, const ApertureImage& image);

/// No point of the response lies farther from its centre, px.
[[nodiscard]] double largest_reach_px(const Aperture& aperture, const ApertureImage& image);

/// The response of any aperture, cut to a window; its values add up to 1 without the cut (0 where nothing
/// passes). The aperture is divided into cells, each of which spreads its light evenly over its own image:
/// cells of a picture, or rings and sectors so fine that their images follow a curve within 0.02 px. Folds,
/// where several zones meet, add up.
[[nodiscard]] ResponseGrid dense_response(const Aperture& aperture, const ApertureImage& image,
                                          const PixelWindow& window);

/// The same by `points`^2 rays through the aperture, counted per pixel: slow, obvious, for tests.
[[nodiscard]] ResponseGrid ray_response(const Aperture& aperture, const ApertureImage& image,
                                        const PixelWindow& window, int points);

}  // namespace postlens
