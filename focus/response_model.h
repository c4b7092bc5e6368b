// Which impulse response a lens has, in the form that scattering wants.
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "focus/kernel.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// A point of light as it arrives: the aperture's point q, in units of its radius, is moved by `map_px q`,
/// and by what the model adds.
struct ResponseRequest {
    glm::dmat2 map_px{1};
    glm::dvec2 place_px{0};  ///< of the point, from the picture's middle
    bool whole = true;       ///< as if nothing were lost: what the weights are spread by
    glm::dvec2 phase_px{0};  ///< of the response's centre from the anchor
    KernelReach reach;
};

/// Responses of one lens setting. What is round everywhere needs none of the functions: its kernels are those
/// of discs and ellipses, and the fastest.
class ResponseModel {
  public:
    ResponseModel() = default;
    ResponseModel(const ResponseModel&) = delete;
    ResponseModel& operator=(const ResponseModel&) = delete;
    ResponseModel(ResponseModel&&) = delete;
    ResponseModel& operator=(ResponseModel&&) = delete;
    virtual ~ResponseModel() = default;

    [[nodiscard]] virtual bool is_round() const { return true; }
    /// Whether a response is an evenly lit outline, and so costs as much as that.
    [[nodiscard]] virtual bool is_even() const { return true; }
    /// Whether responses of opposite maps are the same.
    [[nodiscard]] virtual bool is_point_symmetric() const { return true; }
    /// Width of the part of the picture, px, over which one kernel of this map serves: its outline changes
    /// by less than half a pixel, or hardly next to its size. 0: the whole.
    [[nodiscard]] virtual double cell_px(const glm::dmat2& /*map_px*/) const { return 0; }
    /// Whether the weights that pictures are divided by spread as the light does at its place. False: as it
    /// would if nothing were lost.
    [[nodiscard]] virtual bool weighs_as_it_shines() const { return false; }
    /// Share of the light that is not lost at a place, counted as ResponseRequest's.
    [[nodiscard]] virtual double transmission(const glm::dvec2& /*place_px*/,
                                              double /*inverse_depth_per_m*/) const {
        return 1;
    }
    /// No light arrives farther from the centre than this, px.
    [[nodiscard]] virtual double reach_px(const glm::dmat2& /*map_px*/) const { return 0; }
    /// Its values add up to 1 where the reach does not cut it, or to 0 where nothing passes.
    [[nodiscard]] virtual Kernel kernel(const ResponseRequest& /*request*/) const { return {}; }

    /// Responses that are dear to make come in few phases from this radius on, px.
    [[nodiscard]] virtual double few_phases_from_px() const { return HUGE_VAL; }

    /// Whether red, green and blue have responses of their own: then `channel_kernels` stands for `kernel`.
    [[nodiscard]] virtual bool has_channels() const { return false; }
    /// Whether maps other than a multiple of the identity have responses of their own; else what mirrors and
    /// glass stretch has that of its mean.
    [[nodiscard]] virtual bool takes_maps() const { return true; }
    /// Of all requests, which share their phase; runs in parallel itself.
    [[nodiscard]] virtual std::vector<std::array<Kernel, 3>> channel_kernels(
        std::span<const ResponseRequest> /*requests*/) const {
        return {};
    }
};

/// Of an aperture.
[[nodiscard]] std::unique_ptr<ResponseModel> aperture_model(const Aperture& aperture,
                                                            const FocusGeometry& geometry,
                                                            double half_diagonal_px);

/// Of a lens setting. `half_diagonal_px`: of the picture, in the px that the geometry counts in. Throws
/// Error(wrong_arguments) and Error(invalid_input) as read_aperture does, and for kinds that scattering
/// real lenses, which lens_model (focus/lens_model.h) makes.
[[nodiscard]] std::unique_ptr<ResponseModel> response_model(const Impulse& impulse,
                                                            const FocusGeometry& geometry,
                                                            double half_diagonal_px);

}  // namespace postlens
