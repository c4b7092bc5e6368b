#include "lens/wave/spectrum.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "lens/wave/wave_scale.h"

namespace postlens {

Spectrum channel_bands() {
    constexpr std::array<double, 3> centre_nm = {611, 549, 464};
    constexpr double half_width_nm = 64, first_nm = 440, spacing_nm = 32;
    Spectrum lines(7);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        lines[i].wavelength_nm = first_nm + spacing_nm * static_cast<double>(i);
    }
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (SpectralLine& line : lines) {
            const double away = (line.wavelength_nm - centre_nm[c]) / half_width_nm;
            const double cosine = std::abs(away) < 1 ? std::cos(std::numbers::pi / 2 * away) : 0;
            line.weight[c] = cosine * cosine;
            sum += line.weight[c];
        }
        for (SpectralLine& line : lines) line.weight[c] /= sum;
    }
    return lines;
}

Spectrum equal_lines(std::span<const double> wavelengths_nm) {
    constexpr std::size_t most = 64;
    if (wavelengths_nm.empty() || wavelengths_nm.size() > most) {
        fail(ExitCode::wrong_arguments, "number of wavelengths is out of range (got {}; expected 1 to {})",
             wavelengths_nm.size(), most);
    }
    Spectrum lines;
    const double weight = 1 / static_cast<double>(wavelengths_nm.size());
    for (const double wavelength_nm : wavelengths_nm) {
        check_wavelength(wavelength_nm);
        lines.push_back({wavelength_nm, {weight, weight, weight}});
    }
    return lines;
}

}  // namespace postlens
