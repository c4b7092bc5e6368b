#include "focus/lens_model.h"

#include <algorithm>
#include <cmath>

#include "lens/prescription/read_prescription.h"
#include "lens/traced/fan_table.h"

namespace postlens {
namespace {

double mean_of(const glm::dmat2& map) {
    return (map[0].x + map[1].y) / 2;
}

class LensModel final : public ResponseModel {
  public:
    LensModel(const LensView& view, const FocusGeometry& geometry, double half_diagonal_px,
              double largest_inverse_depth_per_m)
        : geometry_(geometry),
          table_(view, largest_inverse_depth_per_m, half_diagonal_px / geometry.gain_px) {}

    [[nodiscard]] bool is_round() const override { return false; }
    [[nodiscard]] bool is_even() const override { return false; }
    [[nodiscard]] bool is_point_symmetric() const override { return false; }
    // To save time, kernels are computed only for certain positions of their centre within a pixel, and
    // samples are rounded to these. Kernels with at least this blur radius, in px, have fewer such positions
    // than smaller kernels. In so wide a blur, the difference is invisible.
    [[nodiscard]] double few_phases_from_px() const override { return 2; }
    [[nodiscard]] bool varies_over_field() const override { return true; }
    [[nodiscard]] double cell_px(const glm::dmat2& map_px) const override {
        // Returns the width, in px, of square parts of the image in which samples with the same blur share
        // one kernel. They are so small that within a square, the light of the true kernel moves by at most
        // half a pixel or 2 % of the kernel's radius, whichever is larger.
        constexpr double within_px = 0.5, within_share = 0.02, narrowest_px = 8, widest_px = 1024;
        const double w = inverse_depth_per_m(map_px);
        const double within = std::max(within_px, within_share * geometry_.gain_px * table_.reach(w));
        return std::clamp(within / std::max(table_.change_over_field(w), 1e-9), narrowest_px, widest_px);
    }
    [[nodiscard]] double transmission(const glm::dvec2& place_px,
                                      double /*inverse_depth_per_m*/) const override {
        return table_.light(glm::length(place_px) / geometry_.gain_px);
    }
    [[nodiscard]] double reach_px(const glm::dmat2& map_px) const override {
        const glm::dmat2 further = map_px - glm::dmat2(mean_of(map_px));
        // Curved mirrors and glass cause astigmatism, the part `further` of the blur that is not a uniform
        // scale. It displaces light by up to `stretched`, in px. The factor 1.5 is a margin, because the
        // lens's true opening (pupil) may be wider than the nominal aperture.
        const double stretched = 1.5 * std::hypot(glm::length(further[0]), glm::length(further[1]));
        return geometry_.gain_px * table_.reach(inverse_depth_per_m(map_px)) + stretched;
    }
    [[nodiscard]] Kernel kernel(const ResponseRequest& request) const override {
        const double place_px = glm::length(request.place_px);
        const double w = inverse_depth_per_m(request.map_px);
        const PupilFan fan = table_.fan(w, place_px / geometry_.gain_px);
        const FanImage image{.gain_px = geometry_.gain_px,
                             .further_px_m = (request.map_px - glm::dmat2(mean_of(request.map_px))) /
                                             geometry_.aperture_radius_m,
                             .axis = place_px > 0 ? request.place_px / place_px : glm::dvec2(0, 1),
                             .centre_px = request.phase_px};
        // If the blur is smaller than a pixel, its true shape is invisible, so the blur is drawn as a disc.
        // The advantage is that a disc is symmetric: centred on a pixel corner, it gives each of the four
        // pixels around this corner the same light.
        constexpr double least_px = 0.5;
        const double size_px = fan_reach_px(fan, image);
        if (size_px < least_px)
            return make_kernel(Ellipse::disc(size_px), request.phase_px.x, request.phase_px.y, request.reach);
        const KernelReach& reach = request.reach;
        // A very large blur that is astigmatic because of a curved mirror or glass (`further_px_m` is not 0)
        // is drawn as an ellipse. The ellipse ignores the aberrations of the lens itself, but in so large a
        // blur they are invisible.
        constexpr double widest_bent_px = 128;
        if (size_px > widest_bent_px && image.further_px_m != glm::dmat2(0)) {
            return make_kernel(Ellipse::from_map(request.map_px, least_px), request.phase_px.x,
                               request.phase_px.y, reach);
        }
        return make_kernel(fan_response(fan, image, {-reach.x, reach.x, -reach.y, reach.y}), reach);
    }

  private:
    // Returns the inverse depth 1 / z, in 1/m, of a point from its blur. The matrix `map_px` maps a lens
    // point, in lens radii, to a position in the blur, in px. Its mean scale, from which 1 / z is computed,
    // is
    //
    //     gain_px R (1 / s - 1 / z)
    //
    // where gain_px is the film distance in px, R the aperture radius and s the focus distance, in m.
    [[nodiscard]] double inverse_depth_per_m(const glm::dmat2& map_px) const {
        return geometry_.inverse_focus_per_m -
               mean_of(map_px) / (geometry_.gain_px * geometry_.aperture_radius_m);
    }

    FocusGeometry geometry_;
    FanTable table_;
};

}  // namespace

std::unique_ptr<ResponseModel> lens_model(const LensView& view, const FocusGeometry& geometry,
                                          double half_diagonal_px, double largest_inverse_depth_per_m) {
    return std::make_unique<LensModel>(view, geometry, half_diagonal_px, largest_inverse_depth_per_m);
}

std::optional<LensView> real_lens(const FocusSettings& settings, const Film& film, ImageSize picture,
                                  const RasterWindow& recorded) {
    if (settings.impulse.kind != ImpulseKind::lens) return std::nullopt;
    check_impulse(settings.impulse);
    return std::optional<LensView>(
        std::in_place, read_prescription(settings.impulse.file),
        LensViewSettings{.focus_distance_m = settings.focus_distance_m,
                         .f_number = settings.lens.f_number,
                         .framing = settings.framing,
                         .film = film,
                         .half_diagonal_px = std::hypot(picture.width, picture.height) / 2.0,
                         .widest_tangent = std::hypot(recorded.width(), recorded.height()) / 2 *
                                           film.pixel_pitch_mm / film.distance_mm});
}

}  // namespace postlens
