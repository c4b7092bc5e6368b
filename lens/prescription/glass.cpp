#include "lens/prescription/glass.h"

#include <cmath>
#include <utility>

namespace postlens {
namespace {

double inverse_square_um(double wavelength_nm) {
    const double um = wavelength_nm * 1e-3;
    return 1 / (um * um);
}

}  // namespace

Glass Glass::constant(double index, std::string name) {
    Glass out;
    out.terms_ = {index, 0, 0, 0, 0, 0};
    out.name_ = std::move(name);
    return out;
}

Glass Glass::abbe(double nd, double vd, std::string name) {
    Glass out;
    const double slope = (nd - 1) / vd / (inverse_square_um(F_line_nm) - inverse_square_um(C_line_nm));
    out.terms_ = {nd - slope * inverse_square_um(d_line_nm), slope, 0, 0, 0, 0};
    out.name_ = std::move(name);
    return out;
}

Glass Glass::sellmeier(const std::array<double, 6>& terms, std::string name) {
    Glass out;
    out.formula_ = Formula::sellmeier;
    out.terms_ = terms;
    out.name_ = std::move(name);
    return out;
}

Glass Glass::laurent(const std::array<double, 6>& terms, std::string name) {
    Glass out;
    out.formula_ = Formula::laurent;
    out.terms_ = terms;
    out.name_ = std::move(name);
    return out;
}

Glass Glass::three_points(const std::array<double, 3>& wavelengths_nm, const std::array<double, 3>& indices,
                          std::string name) {
    std::array<double, 3> x{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = inverse_square_um(wavelengths_nm[i]);
    // The refractive index is a parabola in x, the inverse square of the wavelength. It passes through the
    // three given indices (Newton's divided differences).
    const double first = (indices[1] - indices[0]) / (x[1] - x[0]);
    const double second = ((indices[2] - indices[1]) / (x[2] - x[1]) - first) / (x[2] - x[0]);
    Glass out;
    out.terms_ = {
        indices[0] - x[0] * first + x[0] * x[1] * second, first - (x[0] + x[1]) * second, second, 0, 0, 0};
    out.name_ = std::move(name);
    return out;
}

double Glass::index(double wavelength_nm) const {
    const double x = inverse_square_um(wavelength_nm);
    if (formula_ == Formula::cauchy) return terms_[0] + x * (terms_[1] + x * terms_[2]);
    if (formula_ == Formula::laurent) {
        const auto& a = terms_;
        return std::sqrt(a[0] + a[1] / x + x * (a[2] + x * (a[3] + x * (a[4] + x * a[5]))));
    }
    double square = 1;
    for (std::size_t i = 0; i < 3; ++i) square += terms_[i] / (1 - terms_[i + 3] * x);
    return std::sqrt(square);
}

}  // namespace postlens
