// A picture as the mean of views in two independent halves, whose difference tells its noise.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "focus/field_focus.h"
#include "planner/hybrid.h"
#include "planner/tile_grid.h"
#include "tracer/render_setup.h"
#include "tracer/scene_rays.h"

namespace postlens {

/// Has more and more views of a picture drawn, tile by tile; with the scene, rays where the views are unsure.
class HalvedViews {
  public:
    /// `focus.views` does not count, nor does its method. `first_set`: of the sets of views, other ones for
    /// another number that is 128 or more away. Throws what hybrid_picture throws.
    HalvedViews(FocusFrame& frame, const HybridSettings& settings, int first_set = 0);

    /// Draws what each tile of `grid()` lacks of so many views, of which one half has the greater part where
    /// they are odd. Same bits for any number of threads.
    void draw(const std::vector<int>& views);
    /// Draws tiles, those that are not 0, anew with rays alone; so will be what is drawn of them later.
    void leave_to_rays(const std::vector<std::uint8_t>& tiles);

    [[nodiscard]] const TileGrid& grid() const { return grid_; }
    [[nodiscard]] const FocusGeometry& geometry() const { return by_field_.geometry; }
    [[nodiscard]] bool has_rays() const { return rays_ != nullptr; }
    [[nodiscard]] const std::vector<int>& views() const { return views_; }                 ///< by tile
    [[nodiscard]] const std::vector<std::uint8_t>& left_to_rays() const { return left_; }  ///< by tile
    /// 0 or 1; only what draws said.
    [[nodiscard]] const FieldFocus& half(std::size_t number) const { return halves_[number]; }
    [[nodiscard]] RayCounts rays() const { return rays_ ? rays_->counts() : RayCounts{}; }
    /// The mean of all views that were drawn, and sums of their checks.
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
    std::unique_ptr<RenderSetup> setup_;  ///< none without a scene
    std::unique_ptr<SceneRays> rays_;
    std::unique_ptr<FieldFocuser> focuser_;
    std::vector<int> views_;
    std::vector<std::uint8_t> left_;
    std::array<FieldFocus, 2> halves_;
};

/// The picture of all views, of a crop, with what was traced for it; nothing is stated.
[[nodiscard]] HybridResult finished(FocusFrame& frame, HalvedViews&& views, const std::optional<Crop>& crop);

}  // namespace postlens
