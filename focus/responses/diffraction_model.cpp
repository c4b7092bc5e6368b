#include "focus/responses/diffraction_model.h"

#include <algorithm>
#include <cmath>

#include "lens/wave/diffraction_response.h"
#include "lens/wave/wave_scale.h"

namespace postlens {
namespace {

/// Fraction of the energy that a kernel may leave out.
constexpr double tail = 0.01;
/// Largest distance from the circle of confusion, in px, to which the kernel contains diffracted light.
/// Usually, the kernel ends nearer, where only the fraction `tail` of the energy lies farther out. At this
/// limit, the kernel may lose more energy than that.
constexpr double widest_skirt_px = 256;
/// From this CoC radius on, in px, a uniform disc replaces the diffraction pattern, because its fringes are
/// then finer than a pixel.
constexpr double disc_from_px = 2048;

/// Returns the radius of the circle of confusion, in px. The matrix `map_px` maps a lens point, in lens
/// radii, to its displacement in the blur, in px. It may describe an ellipse, but this model supports only
/// discs, so the mean of its two diagonal elements is used.
double radius_of(const glm::dmat2& map_px) {
    return std::abs(map_px[0].x + map_px[1].y) / 2;
}

class DiffractionModel final : public ResponseModel {
  public:
    DiffractionModel(Spectrum spectrum, const FocusGeometry& geometry)
        : spectrum_(std::move(spectrum)), geometry_(geometry) {
        for (const SpectralLine& line : spectrum_) longest_nm_ = std::max(longest_nm_, line.wavelength_nm);
    }

    [[nodiscard]] bool is_round() const override { return false; }
    [[nodiscard]] bool is_even() const override { return false; }
    [[nodiscard]] bool takes_maps() const override { return false; }
    [[nodiscard]] bool has_channels() const override { return true; }
    [[nodiscard]] double few_phases_from_px() const override { return 0; }
    [[nodiscard]] double reach_px(const glm::dmat2& map_px) const override {
        const double radius_px = radius_of(map_px);
        if (radius_px >= disc_from_px) return radius_px;
        const double v_per_px = wave_scale(geometry_, geometry_.inverse_focus_per_m, longest_nm_).v_per_px;
        return std::min(radius_of_tail(v_per_px * radius_px, tail) / v_per_px, radius_px + widest_skirt_px);
    }
    [[nodiscard]] std::vector<std::array<Kernel, 3>> channel_kernels(
        std::span<const ResponseRequest> requests) const override {
        std::vector<double> diameters_px;
        std::vector<std::size_t> by_waves;
        std::vector<std::array<Kernel, 3>> out(requests.size());
        double widest_px = 0;
        for (std::size_t i = 0; i < requests.size(); ++i) {
            const ResponseRequest& r = requests[i];
            const double radius_px = radius_of(r.map_px);
            if (radius_px >= disc_from_px) {
                out[i].fill(make_kernel(Ellipse::disc(radius_px), r.phase_px.x, r.phase_px.y, r.reach));
                continue;
            }
            by_waves.push_back(i);
            diameters_px.push_back(2 * radius_px);
            widest_px = std::max(widest_px, radius_px);
        }
        if (by_waves.empty()) return out;
        DiffractionSettings settings;
        settings.spectrum = spectrum_;
        settings.centre_x = requests[0].phase_px.x;
        settings.centre_y = requests[0].phase_px.y;
        settings.tail = tail;
        settings.max_radius_px = widest_px + widest_skirt_px;
        const std::vector<ChannelResponses> responses =
            diffraction_responses(geometry_, diameters_px, settings);
        for (std::size_t k = 0; k < by_waves.size(); ++k) {
            const std::size_t i = by_waves[k];
            for (std::size_t c = 0; c < 3; ++c)
                out[i][c] = make_kernel(responses[k].channel[c], requests[i].reach);
        }
        return out;
    }

  private:
    Spectrum spectrum_;
    FocusGeometry geometry_;
    double longest_nm_ = 0;
};

}  // namespace

std::unique_ptr<ResponseModel> diffraction_model(const std::vector<double>& wavelengths_nm,
                                                 const FocusGeometry& geometry) {
    return std::make_unique<DiffractionModel>(
        wavelengths_nm.empty() ? channel_bands() : equal_lines(wavelengths_nm), geometry);
}

}  // namespace postlens
