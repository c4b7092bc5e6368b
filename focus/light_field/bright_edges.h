// Finds pixels at the edges of very bright surfaces, in which views are too noisy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "focus/responses/node_response.h"
#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// The pixels at the edges of very bright surfaces that the views show, and the number of additional rays for
/// each.
///
/// Blur kernels spread the light of most small bright surfaces, because the mean of a few samples is noisy
/// there. For example, a lamp of radiance 100 changes a pixel by 0.4 for each of 256 samples that meets it.
/// Surfaces that may be partly hidden are left to the views and rays, so the pixels at their edges get more
/// rays.
class BrightEdges {
  public:
    BrightEdges() = default;
    /// - `recorded`: the pixels of the sample file. The number of rays is limited in proportion to them, so a
    ///   cropped image gets the same rays as the whole one.
    explicit BrightEdges(const RasterWindow& recorded);
    /// Adds the edges of the bright surfaces in `sheets` that `rule` does not leave to blur kernels.
    void add(const TreeSheets& sheets, const HighlightRule& rule, const PatchLens& lens);
    /// Reduces the largest numbers of rays until the mean over all pixels is within the limit. Call it after
    /// the last `add`.
    void limit();
    /// Returns the number of additional rays per view in the pixel (x, y), raster px.
    [[nodiscard]] int rays(int x, int y) const {
        const RasterWindow& r = recorded_;
        return x < r.x_begin || x >= r.x_end || y < r.y_begin || y >= r.y_end ? 0 : rays_[index(x, y)];
    }
    /// Returns the largest number of additional rays of a pixel.
    [[nodiscard]] int most() const { return most_; }
    /// Returns the largest number of additional rays of a pixel in a part of the raster.
    [[nodiscard]] int most_in(const RasterWindow& window) const;

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - recorded_.y_begin) * static_cast<std::size_t>(recorded_.width()) +
               static_cast<std::size_t>(x - recorded_.x_begin);
    }
    void add(const SheetMesh& mesh, const HighlightRule& rule, const PatchLens& lens);

    RasterWindow recorded_{};
    std::vector<std::uint8_t> rays_;
    int most_ = 0;
};

}  // namespace postlens
