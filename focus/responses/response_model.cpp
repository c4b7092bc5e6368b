#include "focus/responses/response_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "focus/responses/diffraction_model.h"
#include "lens/aperture_response.h"
#include "pictures/aperture_file.h"

namespace postlens {
namespace {

class ApertureModel final : public ResponseModel {
  public:
    ApertureModel(const Aperture& aperture, const FocusGeometry& geometry, double half_diagonal_px)
        : aperture_(aperture),
          spherical_px_(geometry.gain_px * geometry.aperture_radius_m * aperture.spherical_per_m()),
          half_diagonal_px_(half_diagonal_px),
          inverse_focus_per_m_(geometry.inverse_focus_per_m),
          map_px_m_(geometry.gain_px * geometry.aperture_radius_m),
          rim_distance_m_(aperture.cats_eye() * map_px_m_ / half_diagonal_px) {}

    [[nodiscard]] bool is_round() const override { return false; }
    [[nodiscard]] bool is_even() const override { return postlens::is_even(aperture_, image({})); }
    [[nodiscard]] bool is_point_symmetric() const override { return aperture_.is_point_symmetric(); }
    [[nodiscard]] bool varies_over_field() const override { return aperture_.varies_over_field(); }
    [[nodiscard]] double cell_px(const glm::dmat2& map_px) const override {
        if (!varies_over_field()) return 0;
        const double radius_px = reach_px(map_px);
        // Computes the width of the squares of the image in which samples share one blur kernel. Vignetting
        // cuts off a part of the blur. If the position in the image changes by 1 px, the edge of this cut
        // moves by `moves` px within the kernel. It may move by within_px in a square.
        const double moves = aperture_.cats_eye() * radius_px / half_diagonal_px_;
        constexpr double within_px = 0.5, narrowest_px = 8, widest_px = 1024;
        return std::clamp(within_px / std::max(moves, 1e-9), narrowest_px, widest_px);
    }
    [[nodiscard]] double transmission(const glm::dvec2& place_px, double inverse_depth_per_m) const override {
        return aperture_.transmission(place_px / half_diagonal_px_, rim_scale(inverse_depth_per_m));
    }
    [[nodiscard]] double spherical_px() const override { return spherical_px_; }
    [[nodiscard]] double reach_px(const glm::dmat2& map_px) const override {
        return largest_reach_px(aperture_, image({.map_px = map_px}));
    }
    [[nodiscard]] double farthest_light_px(double radius_px) const override {
        return postlens::farthest_light_px(aperture_, radius_px, spherical_px_);
    }
    [[nodiscard]] Kernel kernel(const ResponseRequest& request) const override {
        const ApertureImage at = image(request);
        // The shape of a blur smaller than a pixel is invisible, so a disc replaces it.
        constexpr double least_px = 0.5;
        const double size_px = largest_reach_px(aperture_, at);
        if (size_px < least_px)
            return make_kernel(Ellipse::disc(size_px), request.phase_px.x, request.phase_px.y, request.reach);
        // All samples in a square of the image share one blur kernel, computed for the square's centre, which
        // `at` describes. If vignetting blocks all light there, the kernel of the image's centre (`whole`),
        // where there is no vignetting, is used instead.
        ApertureImage whole = at;
        whole.field = {0, 0};
        if (postlens::is_even(aperture_, at)) {
            Outline outline = image_outline(aperture_, at);
            if (outline.empty()) outline = image_outline(aperture_, whole);
            return make_kernel(OutlineRows(outline), request.reach);
        }
        const KernelReach& reach = request.reach;
        const bool is_dark = !(aperture_.transmission(at.field, at.rim_scale) > 0);
        return make_kernel(
            dense_response(aperture_, is_dark ? whole : at, {-reach.x, reach.x, -reach.y, reach.y}), reach);
    }

  private:
    [[nodiscard]] ApertureImage image(const ResponseRequest& r) const {
        return {
            .map_px = r.map_px,
            .spherical_px = spherical_px_,
            .field = r.place_px / half_diagonal_px_,
            // Computes the apparent size of the rim that causes vignetting. It depends on the scene point's
            // depth z, which follows from the point's signed blur radius map_px_m_ (1 / s - 1 / z), where s
            // is the focus distance. This radius is the mean of the two diagonal entries of r.map_px.
            .rim_scale = rim_scale(inverse_focus_per_m_ - (r.map_px[0].x + r.map_px[1].y) / 2 / map_px_m_),
            .centre_px = r.phase_px};
    }

    [[nodiscard]] double rim_scale(double inverse_depth_per_m) const {
        return 1 - rim_distance_m_ * inverse_depth_per_m;
    }

    Aperture aperture_;
    double spherical_px_;
    double half_diagonal_px_;
    double inverse_focus_per_m_;
    double map_px_m_;  ///< displacement seen from the lens's rim, in px, per 1/m of defocus
    double rim_distance_m_;
};

}  // namespace

std::unique_ptr<ResponseModel> aperture_model(const Aperture& aperture, const FocusGeometry& geometry,
                                              double half_diagonal_px) {
    if (aperture.is_round()) return std::make_unique<ResponseModel>();
    return std::make_unique<ApertureModel>(aperture, geometry, half_diagonal_px);
}

std::unique_ptr<ResponseModel> response_model(const Impulse& impulse, const FocusGeometry& geometry,
                                              double half_diagonal_px) {
    switch (impulse.kind) {
        case ImpulseKind::diffraction:
            check_impulse(impulse);
            return diffraction_model(impulse.wavelengths_nm, geometry);
        case ImpulseKind::lens:
            fail(ExitCode::wrong_arguments,
                 "--impulse: has no aperture of its own (got {}; expected disc, polygon, image or "
                 "diffraction)",
                 impulse_text(impulse));
        case ImpulseKind::disc:
        case ImpulseKind::polygon:
        case ImpulseKind::picture:
            break;
    }
    return aperture_model(read_aperture(impulse), geometry, half_diagonal_px);
}

}  // namespace postlens
