// An aperture as light sees it: which points of the lens it lets through, and how much.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lens/impulse.h"
#include "lens/outline.h"

namespace postlens {

/// Brightness on a rectangle of cells, row by row; the longer side of the picture spans [-1, 1].
struct AperturePicture {
    int width = 0, height = 0;
    std::vector<double> light;  ///< >= 0, not all 0
};

/// The point of the unit disc that (u, v) picks, evenly by area; neighbours stay neighbours [shirley1997].
[[nodiscard]] glm::dvec2 disc_point(double u, double v);

/// Points of the lens in units of its radius F / 2n, in raster axes: x to the right, y down. A place of the
/// field is counted from the picture's middle, its corners at length 1.
///
/// - disc: the unit disc. polygon: inscribed in it. picture: its cells.
/// - squeeze: x is divided by it, as an anamorphic lens does to what is out of focus.
/// - cats_eye X: a second rim in front of the lens, a disc as large and as squeezed: light through q that
///   comes from the direction t passes where |q + X t| <= 1, t in units of the picture's corner. What both
///   let through is left; the rest of the light is lost, in focus as well. A point at the field f and the
///   depth z has t = f - q (L/X)/z with L = X R gain/half diagonal, the rim's distance; so |k q + X f| <= 1
///   with the `rim_scale` k = 1 - L/z, next to 1 for all but the nearest things.
/// - spherical X, 1/m: the zone of radius rho of the lens is focused at the inverse distance 1/s + X rho^2
///   (primary spherical aberration; X > 0 undercorrected). Before or behind the focus the response then has
///   a bright rim and a soft edge, exchanged for X < 0.
class Aperture {
  public:
    /// Of a geometric kind: disc, polygon, or picture with the picture given. Throws Error(wrong_arguments)
    /// for settings that check_impulse refuses, Error(invalid_input) for a picture without light.
    explicit Aperture(const Impulse& impulse, std::optional<AperturePicture> picture = std::nullopt);

    /// The unit disc, everywhere: what everything else is measured against.
    [[nodiscard]] bool is_round() const;
    /// Whether a response is the same upside down, so that before and behind the focus do not differ.
    [[nodiscard]] bool is_point_symmetric() const;
    [[nodiscard]] bool varies_over_field() const { return impulse_.cats_eye != 0; }
    [[nodiscard]] double cats_eye() const { return impulse_.cats_eye; }
    [[nodiscard]] double spherical_per_m() const { return impulse_.spherical; }
    /// Half the width and height of the box around it.
    [[nodiscard]] glm::dvec2 half_extent() const { return half_extent_; }
    /// No point of it lies farther from the middle.
    [[nodiscard]] double farthest() const { return farthest_; }

    /// The rim as a place of the field sees it, chords within `tolerance`. Not for pictures. Empty where
    /// nothing passes.
    [[nodiscard]] Outline outline(const glm::dvec2& field, double tolerance, double rim_scale = 1) const;
    /// The second rim alone; a square around everything where the rim is too far off to matter.
    [[nodiscard]] Outline second_rim(const glm::dvec2& field, double tolerance, double rim_scale) const;
    [[nodiscard]] const std::optional<AperturePicture>& picture() const { return picture_; }
    /// Whether a point of the aperture also passes the second rim.
    [[nodiscard]] bool passes(const glm::dvec2& q, const glm::dvec2& field, double rim_scale = 1) const;
    /// Share of the aperture's light that passes; 1 without a second rim. Exact for the disc; of others from
    /// a table, within 1e-3 for a rim_scale of 1, from which it goes on in proportion to the disc's.
    [[nodiscard]] double transmission(const glm::dvec2& field, double rim_scale = 1) const;

    /// The point of the aperture, without the second rim, that (u, v) in [0, 1) picks, as evenly as the light
    /// comes through; neighbours mostly stay neighbours.
    [[nodiscard]] glm::dvec2 sample(double u, double v) const;

    /// The same for equal apertures, and hardly ever for others.
    [[nodiscard]] std::uint64_t fingerprint() const;

  private:
    [[nodiscard]] Outline whole(double tolerance) const;
    [[nodiscard]] double share_passing(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] double share_of_disc(const glm::dvec2& field, double rim_scale) const;
    [[nodiscard]] bool is_plain_disc() const { return impulse_.kind == ImpulseKind::disc; }
    void lay_transmission_table();

    /// Per axis of the field, over [-1, 1]. Between the steps what passes is told too low: of a
    /// hexagon's light 0.05 % less arrives with 32 than with 128, and 0.025 % less with 64.
    [[nodiscard]] int table_steps() const { return picture_ ? 32 : 64; }
    static constexpr int table_slices = 9;  ///< rim_scale 1, 0.9375, ... 0.5; at 0 nothing is lost
    Impulse impulse_;
    std::optional<AperturePicture> picture_;
    glm::dvec2 half_extent_{1};
    double farthest_ = 1;
    Outline rim_;                                 ///< fine, for samples
    std::vector<double> rim_light_;               ///< running share of the fan of triangles from the middle
    std::vector<double> row_light_, cell_light_;  ///< running shares of the picture's rows and in each row
    std::vector<float> transmission_;             ///< by rows; empty where all passes
};

}  // namespace postlens
