// Measures, with traced rays, the error of an image's highlights (bright spots that the lens blurs over many
// pixels).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Measures the error of the light that highlights (bright spots, blurred by the lens) add to the pixels of a
/// tile. Rays are aimed at the recorded highlights (Lights::aim), because few rays through random lens points
/// hit a small light source.
class CheckedHighlights {
  public:
    std::vector<HighlightCheck> sums;  ///< per pixel

    /// Measures the error of `light`, the light that highlights add to the image, in randomly selected pixels
    /// (PatchViews::aimed). `sums` receives the sum and the number of the rays that measure it. The number of
    /// the test rays traced before is added to `checks`.
    void check(const PatchField& field, const PatchViews& set, const TilePlace& at,
               const std::vector<double>& light, std::vector<PixelCheck>& checks);

  private:
    struct Aimed {
        std::uint16_t pixel = 0;
        std::uint32_t rays = 0;
        std::array<double, 3> sum{}, least{}, most{};
        [[nodiscard]] bool rays_differ() const;
    };
    enum class Round : std::uint8_t { deciding, few, many };
    void trace(const PatchField& field, const PatchViews& set, const TilePlace& at, Round round,
               std::vector<Aimed>& aimed);
    void trace_lines(const PatchViews& set, std::vector<Aimed>& aimed);

    std::vector<Aimed> aimed_, agreeing_, differing_;
    std::vector<std::uint32_t> sources_;
    std::vector<Lights::Line> aims_;
    // One element per ray.
    std::vector<SightLine> lines_;
    std::vector<NodeIdentity> highlights_;
    std::vector<double> scales_;
    std::vector<std::size_t> aimed_of_line_;
    std::vector<std::array<float, 3>> radiance_;  ///< of the highlights
};

}  // namespace postlens
