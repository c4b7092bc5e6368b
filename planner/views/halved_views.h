// Divides the views of an image (reprojections to different lens points) into two independent halves, whose
// difference shows the noise.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "focus/light_field/field_focus.h"
#include "planner/hybrid.h"
#include "planner/views/checked_pixels.h"
#include "planner/views/tile_grid.h"
#include "tracer/distributed/render_setup.h"
#include "tracer/distributed/scene_rays.h"

namespace postlens {

/// Averages the views of an image (reprojections to different lens points) in several steps, with a number of
/// views for each tile. With a scene, rays replace colours that the records do not determine.
class HalvedViews {
  public:
    /// `focus.views` and `focus.method` of `settings` are ignored. The image uses up to 127 sets of lens
    /// points, with numbers from `first_set` on. Throws the errors of hybrid_picture.
    HalvedViews(FocusFrame& frame, const HybridSettings& settings, int first_set = 0);

    /// Adds lens points, in two halves, until each tile of `grid()` has `views[tile]`. Half 0 may have one
    /// more. The result is bit-identical for any number of threads.
    void draw(const std::vector<int>& views);
    /// From now on, rays replace all samples in the tiles whose entry in `tiles` is not 0, and highlights if
    /// `what` says so. Returns whether a tile was redrawn.
    bool leave_to_rays(const std::vector<std::uint8_t>& tiles, LeftToRays what);

    [[nodiscard]] const TileGrid& grid() const { return grid_; }
    [[nodiscard]] const FocusGeometry& geometry() const { return by_field_.geometry; }
    [[nodiscard]] bool has_rays() const { return rays_ != nullptr; }
    [[nodiscard]] const std::vector<int>& views() const { return views_; }               ///< per tile
    [[nodiscard]] const std::vector<LeftToRays>& left_to_rays() const { return left_; }  ///< per tile
    /// Returns the mean over the lens points of half 0 or 1, as far as drawn.
    [[nodiscard]] const FieldFocus& half(std::size_t number) const { return halves_[number]; }
    [[nodiscard]] const CheckedPixels& checked_pixels() const { return checked_pixels_; }
    [[nodiscard]] RayCounts rays() const { return rays_ ? rays_->counts() : RayCounts{}; }
    /// Returns the mean over all lens points so far. Its `checks` contain sums over both halves.
    [[nodiscard]] FieldFocus whole() &&;

  private:
    [[nodiscard]] static int of_half(int views, std::size_t half) {
        return half == 0 ? (views + 1) / 2 : views / 2;
    }
    void take(FieldFocus&& drawn, std::size_t half, const std::vector<int>& views);

    FieldFocusSettings by_field_;
    TileGrid grid_;
    int first_set_;
    std::function<void(int x, int y, std::vector<std::uint32_t>& views)> checked_;
    CheckedPixels checked_pixels_;
    std::unique_ptr<RenderSetup> setup_;  ///< null without a scene
    std::unique_ptr<SceneRays> rays_;
    std::unique_ptr<FieldFocuser> focuser_;
    std::vector<int> views_;
    std::vector<LeftToRays> left_;
    std::array<FieldFocus, 2> halves_;
};

/// Returns the mean of all views, with the number of rays, and the fraction of the samples within `crop` that
/// rays replaced. `stated` (the measured error) stays empty.
[[nodiscard]] HybridResult finished(FocusFrame& frame, HalvedViews&& views, const std::optional<Crop>& crop);

}  // namespace postlens
