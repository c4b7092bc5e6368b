// Interface for models of lens blur, which compute blur kernels on the pixel grid.
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "focus/responses/kernel.h"
#include "lens/aperture.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Describes a blur kernel to be computed. `map_px` is a matrix that converts a lens point, in lens radii, to
/// a position in px relative to the kernel's centre. Without aberrations, light through this lens point
/// arrives there.
struct ResponseRequest {
    glm::dmat2 map_px{1};
    glm::dvec2 place_px{0};  ///< position of the scene point relative to the image's centre
    glm::dvec2 phase_px{0};  ///< position of the response's centre relative to the anchor
    KernelReach reach;
};

/// Computes the blur kernels of a lens with given settings, for example a given f-number and focus distance.
/// This base class describes a lens with a round aperture, whose kernels are discs and ellipses. It is the
/// fastest model. Derived classes describe other lenses.
class ResponseModel {
  public:
    ResponseModel() = default;
    ResponseModel(const ResponseModel&) = delete;
    ResponseModel& operator=(const ResponseModel&) = delete;
    ResponseModel(ResponseModel&&) = delete;
    ResponseModel& operator=(ResponseModel&&) = delete;
    virtual ~ResponseModel() = default;

    [[nodiscard]] virtual bool is_round() const { return true; }
    /// Returns whether blur kernels are uniform inside their outline. Such a kernel is added to the image
    /// faster: the time is proportional to the length of its outline, not to its area.
    [[nodiscard]] virtual bool is_even() const { return true; }
    /// Returns whether turning the aperture by 180 degrees does not change the blur.
    [[nodiscard]] virtual bool is_point_symmetric() const { return true; }
    /// Returns whether the blur depends on the position in the image.
    [[nodiscard]] virtual bool varies_over_field() const { return false; }
    /// Returns the width, in px, of the squares of the image in which samples with the same blur share one
    /// kernel. If one kernel serves the whole image, the result is 0. The matrix `map_px`, which converts
    /// lens points to px, gives the size of the blur.
    [[nodiscard]] virtual double cell_px(const glm::dmat2& /*map_px*/) const { return 0; }
    /// Returns the transmittance of the lens for a scene point at `place_px` from the image's centre, from 0
    /// to 1.
    [[nodiscard]] virtual double transmission(const glm::dvec2& /*place_px*/,
                                              double /*inverse_depth_per_m*/) const {
        return 1;
    }
    /// Returns by how many px in the image spherical aberration displaces rays through the rim of the lens.
    [[nodiscard]] virtual double spherical_px() const { return 0; }
    /// Returns the radius, in px, outside which the blur kernel is 0.
    [[nodiscard]] virtual double reach_px(const glm::dmat2& /*map_px*/) const { return 0; }
    /// Returns the largest distance, in px, over which the light of a scene point is spread. `radius_px` is
    /// the signed radius of its circle of confusion.
    [[nodiscard]] virtual double farthest_light_px(double radius_px) const { return std::abs(radius_px); }
    /// Computes the blur kernel that `request` describes. Its values add up to 1, unless request.reach clips
    /// the kernel. They are all 0 if the lens transmits no light.
    [[nodiscard]] virtual Kernel kernel(const ResponseRequest& /*request*/) const { return {}; }

    /// Blur radius, in px, from which on a kernel is computed for fewer subpixel positions of its centre than
    /// usual. This saves time if kernels are expensive to compute.
    [[nodiscard]] virtual double few_phases_from_px() const { return HUGE_VAL; }

    /// Returns whether red, green and blue have different blur kernels. If so, `channel_kernels` is called
    /// instead of `kernel`.
    [[nodiscard]] virtual bool has_channels() const { return false; }
    /// Returns whether this model can compute astigmatic blur kernels, which differ in width along two
    /// directions. Curved mirrors and glass can cause such blur. If the model cannot, surfaces seen in
    /// mirrors or through glass are blurred by the mean radius of their circle of confusion.
    [[nodiscard]] virtual bool takes_maps() const { return true; }
    /// Computes three blur kernels for each request: one for red, one for green and one for blue. Works in
    /// parallel. All requests must have the same subpixel position `phase_px`, because their kernels are
    /// computed together.
    [[nodiscard]] virtual std::vector<std::array<Kernel, 3>> channel_kernels(
        std::span<const ResponseRequest> /*requests*/) const {
        return {};
    }
};

/// Creates the model of a thin lens's aperture.
[[nodiscard]] std::unique_ptr<ResponseModel> aperture_model(const Aperture& aperture,
                                                            const FocusGeometry& geometry,
                                                            double half_diagonal_px);

/// Creates the blur model of an aperture. Throws the errors of read_aperture. Throws Error(wrong_arguments)
/// if `impulse` is a real lens, because lens_model creates the model of a real lens.
/// - `half_diagonal_px`: half the diagonal of the image, in px
[[nodiscard]] std::unique_ptr<ResponseModel> response_model(const Impulse& impulse,
                                                            const FocusGeometry& geometry,
                                                            double half_diagonal_px);

}  // namespace postlens
