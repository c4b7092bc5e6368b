// Impulse responses of a ray-traced lens. Each is represented by a fan, which is a bundle of rays from one
// object point through the lens. Fans are traced for a grid of depths and field angles. For object points
// between these, they are interpolated.
#pragma once

#include <vector>

#include "lens/traced/pupil_fan.h"

namespace postlens {

/// A table of fans. A fan is the bundle of rays from one object point that pass the lens. The object points
/// form a grid of inverse depths and of tangents of the angle from the lens axis. Between them, fans are
/// interpolated linearly (errors in docs/lens.md). For nearer points, they are extrapolated.
///
/// Results are bit-identical for any number of threads.
class FanTable {
  public:
    /// Traces the fans of the table for a grid of object points.
    /// - The inverse depths of the object points extend from 0 to the inverse focus distance or to
    ///   largest_inverse_depth_per_m, whichever is larger.
    /// - The tangents of their angles from the axis extend from 0 to `widest_tangent`.
    FanTable(const LensView& view, double largest_inverse_depth_per_m, double widest_tangent);

    [[nodiscard]] PupilFan fan(double inverse_depth_per_m, double tangent) const;
    /// Returns the light that a pixel receives from a uniformly bright scene, relative to the centre pixel.
    /// `tangent` is the tangent of the pixel's angle from the axis.
    [[nodiscard]] double light(double tangent) const;
    /// Returns an upper bound of the blur kernel's radius for object points at an inverse depth, in 1/m. The
    /// radius is given as a fraction of the film distance, so it does not depend on the pixel size.
    [[nodiscard]] double reach(double inverse_depth_per_m) const;
    /// Returns an upper bound of how fast the blur kernel changes over the image, at one inverse depth. If an
    /// object point's pinhole image moves by 1 px, the landing point of each ray relative to this image moves
    /// by at most the returned number of px.
    [[nodiscard]] double change_over_field(double inverse_depth_per_m) const;

    static constexpr std::size_t depths = 7, fields = 25;

  private:
    struct Place {
        std::size_t depth = 0, field = 0;       ///< grid point at or below the given one
        double depth_part = 0, field_part = 0;  ///< fraction of a step; depth_part may be outside 0..1
    };
    [[nodiscard]] Place place(double inverse_depth_per_m, double tangent) const;
    [[nodiscard]] double of_depth(const std::vector<double>& values, double inverse_depth_per_m) const;
    void trace_depth(const LensView& view, std::size_t depth);

    double depth_step_per_m_ = 1, field_step_ = 1;
    std::vector<PupilFan> fans_;          ///< by depth and field
    std::vector<double> light_;           ///< by field
    std::vector<double> reach_, change_;  ///< by depth
};

}  // namespace postlens
