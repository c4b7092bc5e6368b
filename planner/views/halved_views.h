// Makes an image as the mean of its views (reprojections to different lens points). The views are divided
// into two independent halves, whose difference shows the noise.
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

/// Makes an image as the mean of views (reprojections to different lens points). The views form two
/// independent halves, whose difference shows the noise. Each tile (64 px square of the image) has its own
/// number of views, to which more can be added. With a scene, rays replace samples at edges and where no
/// surface is recorded.
class HalvedViews {
  public:
    /// Prepares to draw the views (images from single lens points) of a frame, but draws none yet.
    /// `focus.views` and `focus.method` are ignored. Throws the errors of hybrid_picture.
    /// - `first_set`: number of the first of the 122 sets of lens points that the image uses: 61 for each of
    ///   its two halves
    HalvedViews(FocusFrame& frame, const HybridSettings& settings, int first_set = 0);

    /// Draws more views (images from single lens points), until tile number t of `grid()` has `views[t]` of
    /// them. If this number is odd, half 0 of the views gets one more than half 1. The result is
    /// bit-identical for any number of threads.
    void draw(const std::vector<int>& views);
    /// Lets rays compute all colours of the tiles with a nonzero entry in `tiles`. The views (images from
    /// single lens points) that have been drawn so far are drawn again there. Returns false if rays already
    /// computed all these tiles in this way.
    /// - `what`: whether rays also replace the highlights, whose light is otherwise spread by the lens's
    ///   point spread function
    bool leave_to_rays(const std::vector<std::uint8_t>& tiles, LeftToRays what);

    [[nodiscard]] const TileGrid& grid() const { return grid_; }
    [[nodiscard]] const FocusGeometry& geometry() const { return by_field_.geometry; }
    [[nodiscard]] bool has_rays() const { return rays_ != nullptr; }
    [[nodiscard]] const std::vector<int>& views() const { return views_; }               ///< per tile
    [[nodiscard]] const std::vector<LeftToRays>& left_to_rays() const { return left_; }  ///< per tile
    /// Returns one of two independent estimates of the image. Each is the mean of half of the views (images
    /// from single lens points) that have been drawn so far. `number` is 0 or 1.
    [[nodiscard]] const FieldFocus& half(std::size_t number) const { return halves_[number]; }
    [[nodiscard]] const CheckedPixels& checked_pixels() const { return checked_pixels_; }
    [[nodiscard]] RayCounts rays() const { return rays_ ? rays_->counts() : RayCounts{}; }
    /// Returns the image: the mean of all views drawn so far, from both halves. Its field `checks` contains
    /// the sum of the measured errors of each pixel, that is, the radiance of rays minus the recorded
    /// radiance. It is the sum over the views of both halves.
    [[nodiscard]] FieldFocus whole() &&;

  private:
    [[nodiscard]] static int of_half(int views, std::size_t half) {
        return half == 0 ? (views + 1) / 2 : views / 2;
    }
    void take(FieldFocus& drawn, std::size_t half, const std::vector<int>& views);

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
    std::vector<FieldFocus> spare_;  ///< images whose memory the next draw() uses again
};

/// Returns the image: the mean of all views (images from single lens points) in `views`. The measured error,
/// HybridResult::stated, remains empty, because the caller measures it.
[[nodiscard]] HybridResult finished(FocusFrame& frame, HalvedViews&& views, const std::optional<Crop>& crop);

}  // namespace postlens
