// Impulse responses of a traced lens for every depth and field, by interpolation between fans of rays.
#pragma once

#include <vector>

#include "lens/prescription/pupil_fan.h"

namespace postlens {

/// Fans at a grid of inverse depths and tangents, traced in parallel when it is made; linear in between.
/// Errors against fans traced on the spot: docs/lens.md. The same bits for any number of threads.
class FanTable {
  public:
    /// For inverse depths from 0 to `largest_inverse_depth_per_m` (beyond, responses grow on linearly) and
    /// tangents to `widest_tangent` (beyond, as there). `view` must outlive it.
    FanTable(const LensView& view, double largest_inverse_depth_per_m, double widest_tangent);

    [[nodiscard]] PupilFan fan(double inverse_depth_per_m, double tangent) const;
    /// LensView::light: an even scene lights a pixel equally from any depth.
    [[nodiscard]] double light(double tangent) const;
    /// No response of this depth reaches farther from its point, as a tangent.
    [[nodiscard]] double reach(double inverse_depth_per_m) const;
    /// The farthest that any of its rays moves, relative to its point, per tangent that the point moves.
    [[nodiscard]] double change_over_field(double inverse_depth_per_m) const;

    static constexpr std::size_t depths = 7, fields = 25;

  private:
    struct Place {
        std::size_t depth = 0, field = 0;       ///< of the node before
        double depth_part = 0, field_part = 0;  ///< of a step; that of the depth may lie outside of 0..1
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
