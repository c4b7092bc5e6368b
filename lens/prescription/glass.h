// Refractive index against wavelength.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace postlens {

/// Wavelengths of the lines that indices are stated at, nm: yellow helium, blue and red hydrogen.
inline constexpr double d_line_nm = 587.5618, F_line_nm = 486.1327, C_line_nm = 656.2725;

/// An optically homogeneous medium. Indices are relative to air, which has 1.
class Glass {
  public:
    /// Air.
    Glass() = default;
    /// The same index at every wavelength.
    [[nodiscard]] static Glass constant(double index, std::string name = "");
    /// By nd and Abbe number Vd = (nd - 1) / (nF - nC) > 0: n = A + B / L^2 through both [born1999, 2.3.4].
    /// In the visible within some 1e-4 of real glasses.
    [[nodiscard]] static Glass abbe(double nd, double vd, std::string name = "");
    /// n^2 = 1 + sum B_i L^2 / (L^2 - C_i), L in um [born1999, 2.3.4]; terms B1 B2 B3 C1 C2 C3 (um^2).
    [[nodiscard]] static Glass sellmeier(const std::array<double, 6>& terms, std::string name = "");
    /// n^2 = A0 + A1 L^2 + A2 / L^2 + A3 / L^4 + A4 / L^6 + A5 / L^8, L in um: Laurent's series, in which
    /// Schott's older catalogues state their glasses.
    [[nodiscard]] static Glass laurent(const std::array<double, 6>& terms, std::string name = "");
    /// n = A + B / L^2 + C / L^4 through the indices at three different wavelengths, nm.
    [[nodiscard]] static Glass three_points(const std::array<double, 3>& wavelengths_nm,
                                            const std::array<double, 3>& indices, std::string name = "");

    /// wavelength_nm > 0. Not a number where a formula has a pole or a negative square.
    [[nodiscard]] double index(double wavelength_nm) const;
    [[nodiscard]] bool is_air() const {
        return formula_ == Formula::cauchy && terms_[0] == 1 && terms_[1] == 0 && terms_[2] == 0;
    }
    /// Empty where the source gives none.
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool operator==(const Glass& other) const {
        return formula_ == other.formula_ && terms_ == other.terms_;
    }

  private:
    enum class Formula { cauchy, sellmeier, laurent };
    Formula formula_ = Formula::cauchy;
    std::array<double, 6> terms_{1, 0, 0, 0, 0, 0};  ///< A, B (um^2), C (um^4), or the other formulas'
    std::string name_;
};

}  // namespace postlens
