// Aperture shapes: which points of the lens transmit light, and how much of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lens/impulse.h"
#include "lens/outline.h"

namespace postlens {

/// An aperture given as an image of its transmittance, row by row. The image's longer side spans [-1, 1] on
/// the lens.
struct AperturePicture {
    int width = 0, height = 0;
    std::vector<double> light;  ///< >= 0, not all 0
};

/// Maps (u, v) in [0, 1)^2 to the unit disc [shirley1997]. The map is continuous and preserves ratios of
/// area.
[[nodiscard]] glm::dvec2 disc_point(double u, double v);

/// An aperture. Lens points are in units of the lens radius F / 2n, in raster axes (x right, y down). Field
/// positions are measured from the centre of the image, in units of the distance to an image corner.
///
/// - Shape: the unit disc, a polygon inscribed in the disc, or an image.
/// - squeeze: x is divided by this factor. Bokeh then becomes taller than wide, as with an anamorphic lens.
/// - cats_eye X (mechanical vignetting): a second rim in front of the lens, with the same size and squeeze as
///   the disc. Light from field position f through lens point q passes this rim if |k q + X f| <= 1. For a
///   scene point at depth z, k (`rim_scale`) is 1 - L/z, where L is the distance of the rim from the lens. k
///   is close to 1 except for very near points. L is X R gain / half diagonal, where R is the lens radius and
///   gain is the film distance divided by the pixel pitch. Light that the rim blocks is lost, even for points
///   in focus.
/// - spherical X, 1/m (primary spherical aberration; X > 0 is undercorrected): light through lens points at
///   distance rho from the centre is focused at the inverse distance 1/s + X rho^2, where s is the focus
///   distance. The impulse response has a bright rim on one side of the focus, and a soft edge on the other
///   side.
class Aperture {
  public:
    /// Makes a disc or polygon, or an aperture whose shape and transmittance `picture` gives.
    ///
    /// Throws Error(wrong_arguments) if check_impulse rejects the settings. Throws Error(invalid_input) if
    /// `picture` transmits no light.
    explicit Aperture(const Impulse& impulse, std::optional<AperturePicture> picture = std::nullopt);

    /// Returns true if the aperture is a disc, and there is no squeeze (different width and height),
    /// cat's-eye vignetting or spherical aberration. Blur kernels of surfaces seen directly are then discs.
    [[nodiscard]] bool is_round() const;
    /// Returns true if the aperture is symmetric about its centre. Foreground and background blur of equal
    /// size then look the same.
    [[nodiscard]] bool is_point_symmetric() const;
    [[nodiscard]] bool varies_over_field() const { return impulse_.cats_eye != 0; }
    [[nodiscard]] double cats_eye() const { return impulse_.cats_eye; }
    [[nodiscard]] double spherical_per_m() const { return impulse_.spherical; }
    /// Half the width and height of the aperture's bounding box, in lens radii.
    [[nodiscard]] glm::dvec2 half_extent() const { return half_extent_; }
    /// Largest distance of a point of the aperture from its centre, in lens radii.
    [[nodiscard]] double farthest() const { return farthest_; }

    /// Returns the part of the aperture that cat's-eye vignetting leaves open at image position `field`. The
    /// result is a polygon in lens radii, within `tolerance` lens radii of the true outline. It is empty if
    /// no light passes.
    ///
    /// Not available if the aperture is an image.
    [[nodiscard]] Outline outline(const glm::dvec2& field, double tolerance, double rim_scale = 1) const;
    /// Returns the outline of the second rim of the lens, in lens radii. This rim causes cat's-eye
    /// vignetting. Seen from the scene point at image position `field`, it appears in the plane of the
    /// aperture, with the radius 1 / rim_scale. If rim_scale is below 0.05, the rim blocks no light, and a
    /// large square replaces it.
    [[nodiscard]] Outline second_rim(const glm::dvec2& field, double tolerance, double rim_scale) const;
    [[nodiscard]] const std::optional<AperturePicture>& picture() const { return picture_; }
    /// Returns false if cat's-eye vignetting blocks the light that crosses the aperture at point q, in lens
    /// radii, and travels to image position `field`. The light is blocked by a second rim, which has the
    /// radius 1 / rim_scale in the plane of the lens.
    [[nodiscard]] bool passes(const glm::dvec2& q, const glm::dvec2& field, double rim_scale = 1) const;
    /// Returns the fraction of the aperture's light that cat's-eye vignetting leaves at image position
    /// `field`. The result is exact for a disc. For other shapes, the error is about 1e-3 for distant scene
    /// points, whose rim_scale is close to 1.
    [[nodiscard]] double transmission(const glm::dvec2& field, double rim_scale = 1) const;

    /// Maps (u, v) in [0, 1)^2 to a point of the aperture, with a density proportional to the transmitted
    /// light. The map is continuous almost everywhere. It ignores cat's-eye vignetting.
    [[nodiscard]] glm::dvec2 sample(double u, double v) const;
    /// Returns the transmittance at a point, relative to the aperture's highest. It is 0 outside the
    /// aperture. Cat's-eye vignetting is ignored.
    [[nodiscard]] double transmittance(const glm::dvec2& q) const;

    /// Hash of the aperture's shape and settings.
    [[nodiscard]] std::uint64_t fingerprint() const;

  private:
    [[nodiscard]] Outline whole(double tolerance) const;
    [[nodiscard]] double share_passing(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] double share_of_disc(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] bool is_plain_disc() const { return impulse_.kind == ImpulseKind::disc; }
    void lay_transmission_table();

    [[nodiscard]] int table_steps() const { return picture_ ? 32 : 64; }
    static constexpr int table_slices = 9;  ///< for rim_scale 1, 0.9375, ... 0.5
    Impulse impulse_;
    std::optional<AperturePicture> picture_;
    glm::dvec2 half_extent_{1};
    double farthest_ = 1;
    double most_light_ = 1;          ///< largest value of picture_
    Outline rim_;                    ///< fine polygon from which sample() draws
    std::vector<double> rim_light_;  ///< running sums of the areas of the triangles between centre and rim_
    std::vector<double> row_light_,
        cell_light_;                   ///< running sums of an aperture image's light: by row, and within rows
    std::vector<float> transmission_;  ///< table of cat's-eye transmission; empty if not needed
};

}  // namespace postlens
