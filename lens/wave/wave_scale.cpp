#include "lens/wave/wave_scale.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "lens/impulse.h"

namespace postlens {
namespace {

using std::numbers::pi;
constexpr double m_per_nm = 1e-9, mm_per_nm = 1e-6;

}  // namespace

void check_wavelength(double wavelength_nm) {
    if (wavelength_nm >= shortest_wavelength_nm && wavelength_nm <= longest_wavelength_nm) return;
    fail(ExitCode::wrong_arguments, "wavelength is out of range (got {} nm; expected {} to {} nm)",
         wavelength_nm, shortest_wavelength_nm, longest_wavelength_nm);
}

void check_defocus(double u) {
    if (std::abs(u) <= largest_u) return;
    fail(ExitCode::wrong_arguments,
         "too far out of focus for diffraction to be seen (got u = {:.3g}; expected up to {:.3g}, or the "
         "impulse response disc)",
         u, largest_u);
}

WaveScale wave_scale(const ThinLens& lens, double focus_distance_m, double depth_m, double pixel_pitch_mm,
                     double wavelength_nm) {
    const double v_per_px = pi * pixel_pitch_mm * lens.aperture_diameter_mm() /
                            (wavelength_nm * mm_per_nm * image_distance_mm(lens, focus_distance_m));
    return {.u = v_per_px * coc_diameter_mm(lens, focus_distance_m, depth_m) / pixel_pitch_mm / 2,
            .v_per_px = v_per_px};
}

WaveScale wave_scale(const FocusGeometry& geometry, double inverse_depth_per_m, double wavelength_nm) {
    const double v_per_px =
        2 * pi * geometry.aperture_radius_m / (wavelength_nm * m_per_nm * geometry.gain_px);
    return {.u = v_per_px * geometry.coc_diameter_px(inverse_depth_per_m) / 2, .v_per_px = v_per_px};
}

}  // namespace postlens
