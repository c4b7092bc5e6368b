// Aperture shapes: which points of the lens transmit light, and how much light.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lens/impulse.h"
#include "lens/outline.h"

namespace postlens {

/// An aperture given as an image of its transmittance, row by row. The longer side of the image spans [-1, 1]
/// on the lens.
struct AperturePicture {
    int width = 0, height = 0;
    std::vector<double> light;  ///< >= 0, not all 0
};

/// Maps (u, v) in [0, 1)^2 to the unit disc. The map is continuous and preserves relative area [shirley1997].
[[nodiscard]] glm::dvec2 disc_point(double u, double v);

/// An aperture. Lens points are in units of the lens radius F / 2n, in raster axes (x right, y down). Field
/// positions are measured from the centre of the image; the corners of the image have length 1.
///
/// - Shape: the unit disc, a polygon inscribed in the disc, or an image.
/// - squeeze: divides x, so that bokeh is taller than wide, as with an anamorphic lens.
/// - cats_eye X (mechanical vignetting): a second rim in front of the lens, a disc of the same size and
///   squeeze. Light through lens point q from direction t (in units of the image corner) passes if |q + X t|
///   <= 1. Blocked light is lost, even for points in focus. For a point at field position f and depth z, t =
///   f - q (L/X)/z, where L = X R gain/half diagonal is the distance of the rim and R the lens radius. The
///   condition becomes |k q + X f| <= 1 with `rim_scale` k = 1 - L/z, which is close to 1 except for very
///   near points.
/// - spherical X, 1/m (primary spherical aberration, X > 0 undercorrected): the lens zone of radius rho is
///   focused at the inverse distance 1/s + X rho^2. On one side of the focus, the impulse response has a
///   bright rim; on the other side, it has a soft edge.
class Aperture {
  public:
    /// Makes a disc, a polygon, or the aperture of the given image. Throws Error(wrong_arguments) for
    /// settings that check_impulse rejects, and Error(invalid_input) for an image that transmits no light.
    explicit Aperture(const Impulse& impulse, std::optional<AperturePicture> picture = std::nullopt);

    /// True for the plain unit disc without any modifier.
    [[nodiscard]] bool is_round() const;
    /// True if the aperture is symmetric about its centre. Then the impulse responses in front of and behind
    /// the focus are equal.
    [[nodiscard]] bool is_point_symmetric() const;
    [[nodiscard]] bool varies_over_field() const { return impulse_.cats_eye != 0; }
    [[nodiscard]] double cats_eye() const { return impulse_.cats_eye; }
    [[nodiscard]] double spherical_per_m() const { return impulse_.spherical; }
    /// Half the width and height of the bounding box.
    [[nodiscard]] glm::dvec2 half_extent() const { return half_extent_; }
    /// Largest distance of a point of the aperture from its centre.
    [[nodiscard]] double farthest() const { return farthest_; }

    /// Outline of the part of the aperture that transmits light at a field position, as a polygon whose sides
    /// are within `tolerance` of the curve. Empty if no light passes. Not available for apertures given as
    /// images.
    [[nodiscard]] Outline outline(const glm::dvec2& field, double tolerance, double rim_scale = 1) const;
    /// Outline of the second rim alone. If that rim blocks nothing, a square around the whole aperture.
    [[nodiscard]] Outline second_rim(const glm::dvec2& field, double tolerance, double rim_scale) const;
    [[nodiscard]] const std::optional<AperturePicture>& picture() const { return picture_; }
    /// True if light through this point of the aperture also passes the second rim.
    [[nodiscard]] bool passes(const glm::dvec2& q, const glm::dvec2& field, double rim_scale = 1) const;
    /// Share of the aperture's light that passes the second rim; 1 without a second rim. Exact for the disc.
    /// For other shapes it is interpolated in a table over field and rim_scale, with an error of 1e-3 at
    /// rim_scale 1.
    [[nodiscard]] double transmission(const glm::dvec2& field, double rim_scale = 1) const;

    /// Maps (u, v) in [0, 1)^2 to a point of the aperture, with a density in proportion to the transmitted
    /// light. Ignores the second rim. The map is continuous almost everywhere.
    [[nodiscard]] glm::dvec2 sample(double u, double v) const;
    /// Transmittance at a point, relative to the point that transmits most; 0 outside the aperture. Ignores
    /// the second rim.
    [[nodiscard]] double transmittance(const glm::dvec2& q) const;

    /// Hash of shape and modifiers.
    [[nodiscard]] std::uint64_t fingerprint() const;

  private:
    [[nodiscard]] Outline whole(double tolerance) const;
    [[nodiscard]] double share_passing(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] double share_of_disc(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] bool is_plain_disc() const { return impulse_.kind == ImpulseKind::disc; }
    void lay_transmission_table();

    /// Steps of the transmission table per axis of the field, over [-1, 1]. Interpolation slightly
    /// underestimates the light: for a hexagon, by 0.05 % with 32 steps, relative to 128 steps.
    [[nodiscard]] int table_steps() const { return picture_ ? 32 : 64; }
    static constexpr int table_slices = 9;  ///< rim_scale 1, 0.9375, ... 0.5; at 0 the rim blocks nothing
    Impulse impulse_;
    std::optional<AperturePicture> picture_;
    glm::dvec2 half_extent_{1};
    double farthest_ = 1;
    double most_light_ = 1;          ///< largest value of picture_
    Outline rim_;                    ///< fine polygon from which sample() draws
    std::vector<double> rim_light_;  ///< running sums of the areas of the triangles (centre, side of rim_)
    std::vector<double> row_light_, cell_light_;  ///< running shares of rows, and of cells in each row
    std::vector<float> transmission_;             ///< slices of rows; empty if the rim blocks nothing
};

}  // namespace postlens
