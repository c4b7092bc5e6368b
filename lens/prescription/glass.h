// Refractive index as a function of wavelength.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace postlens {

/// Wavelengths, in nm, at which glass catalogues state refractive indices. They are the helium line d and the
/// hydrogen lines F and C.
inline constexpr double d_line_nm = 587.5618, F_line_nm = 486.1327, C_line_nm = 656.2725;

/// A homogeneous medium. Its refractive index is relative to air, which has index 1.
class Glass {
  public:
    /// Air.
    Glass() = default;
    /// Makes a medium whose refractive index is the same at every wavelength.
    [[nodiscard]] static Glass constant(double index, std::string name = "");
    /// Makes a glass with n = A + B / L^2 at wavelength L [born1999, 2.3.4], from nd (the index at the d
    /// line) and the Abbe number:
    ///
    ///     Vd = (nd - 1) / (nF - nC) > 0
    ///
    /// For real glasses, the error in the visible spectrum is about 1e-4.
    [[nodiscard]] static Glass abbe(double nd, double vd, std::string name = "");
    /// Makes a glass by Sellmeier's formula at wavelength L in um [born1999, 2.3.4]. `terms` are B1 B2 B3 C1
    /// C2 C3, with C in um^2:
    ///
    ///     n^2 = 1 + sum B_i L^2 / (L^2 - C_i)
    [[nodiscard]] static Glass sellmeier(const std::array<double, 6>& terms, std::string name = "");
    /// Makes a glass by the Laurent series of Schott's older catalogues, at wavelength L in um:
    ///
    ///     n^2 = A0 + A1 L^2 + A2 / L^2 + A3 / L^4 + A4 / L^6 + A5 / L^8
    [[nodiscard]] static Glass laurent(const std::array<double, 6>& terms, std::string name = "");
    /// Makes a glass from its indices at three different wavelengths in nm. The index between them is n = A +
    /// B / L^2 + C / L^4.
    [[nodiscard]] static Glass three_points(const std::array<double, 3>& wavelengths_nm,
                                            const std::array<double, 3>& indices, std::string name = "");

    /// Returns the refractive index at wavelength_nm > 0, or NaN where the formula is not defined.
    [[nodiscard]] double index(double wavelength_nm) const;
    [[nodiscard]] bool is_air() const {
        return formula_ == Formula::cauchy && terms_[0] == 1 && terms_[1] == 0 && terms_[2] == 0;
    }
    /// Returns the name of the glass. It is empty if the source gives no name.
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool operator==(const Glass& other) const {
        return formula_ == other.formula_ && terms_ == other.terms_;
    }

  private:
    enum class Formula { cauchy, sellmeier, laurent };
    Formula formula_ = Formula::cauchy;
    std::array<double, 6> terms_{1, 0, 0, 0, 0, 0};  ///< of Cauchy: A, B (um^2), C (um^4)
    std::string name_;
};

}  // namespace postlens
