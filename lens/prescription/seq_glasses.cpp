#include "lens/prescription/seq_glasses.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "core/error.h"
#include "core/text.h"
#include "lens/prescription/formats.h"

namespace postlens {
namespace {

// Returns true if the Sellmeier terms can describe a real glass. The Sellmeier formula's poles must lie
// outside the visible spectrum: below 0.32 um or above 2 um.
bool is_plausible(const std::array<double, 6>& terms) {
    const double n = Glass::sellmeier(terms).index(d_line_nm);
    return n > 1.2 && n < 4 &&
           std::all_of(terms.begin() + 3, terms.end(), [](double c) { return c < 0.1 || c > 4; });
}

}  // namespace

Glass SeqGlasses::find(int line, std::string_view word) const {
    const std::string name = upper_case(word);
    if (name == "AIR") return {};
    if (name == "REFL") seq_unsupported(file_, line, "mirrors are not supported");
    if (const auto own = private_.find(name); own != private_.end()) return own->second;
    if (const auto why = unread_.find(name); why != unread_.end()) {
        fail(ExitCode::invalid_input, "{}:{}: private glass {}: {}", file_, line, excerpt(name), why->second);
    }
    if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
        const double nd = number_in(file_, line, std::string_view(name).substr(0, colon), "nd");
        const double vd = number_in(file_, line, std::string_view(name).substr(colon + 1), "Vd");
        if (vd > 0) return Glass::abbe(nd, vd, name);
    }
    // A glass code such as 517.642 means a refractive index nd of 1.517 and an Abbe number Vd of 64.2.
    const auto is_digits = [](std::string_view part) {
        return part.size() >= 3 && part.size() <= 9 &&
               std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    };
    const std::size_t dot = name.find('.');
    const std::string_view all = name, fraction = all.substr(0, dot == std::string::npos ? 3 : dot),
                           abbe = all.substr(dot == std::string::npos ? std::min<std::size_t>(3, name.size())
                                                                      : dot + 1);
    if (is_digits(fraction) && is_digits(abbe) && (dot != std::string::npos || name.size() == 6)) {
        const double nd = 1 + *parse_number(fraction) / std::pow(10, fraction.size());
        const double vd = *parse_number(abbe) / std::pow(10, abbe.size() - 2);
        if (vd > 0) return Glass::abbe(nd, vd, name);
    }
    return glass_by_name(file_, line, word);
}

// Defines a private glass, that is, a glass that the lens file itself describes. `formula` gives the
// refractive index; missing coefficients are 0.
void SeqGlasses::define_by_formula(int line, const std::string& key, const std::string& formula,
                                   std::vector<double> terms) {
    const bool laurent = formula == "LAU" || formula == "GML",
               sellmeier = formula == "STS" || formula == "GMS";
    if ((!laurent && !sellmeier) || terms.empty() || terms.size() > 6) {
        unread_[key] = fmt::format(
            "line {} is not understood (got the formula {} with {} coefficients; expected "
            "LAU or GML, STS or GMS, with up to 6, or indices)",
            line, excerpt(formula), terms.size());
        return;
    }
    terms.resize(6, 0);
    const auto& t = terms;
    // Some files order Sellmeier coefficients B1 C1 B2 C2 B3 C3, others B1 B2 B3 C1 C2 C3. The order that
    // gives a plausible glass is used.
    const std::array<double, 6> in_order{t[0], t[1], t[2], t[3], t[4], t[5]},
        in_pairs{t[0], t[2], t[4], t[1], t[3], t[5]};
    if (laurent) {
        private_[key] = Glass::laurent(in_order, key);
    } else if (is_plausible(in_order) != is_plausible(in_pairs)) {
        private_[key] = Glass::sellmeier(is_plausible(in_order) ? in_order : in_pairs, key);
    } else {
        unread_[key] = fmt::format(
            "line {} is not understood (got coefficients of {} that make a glass in {} of the "
            "orders B1 C1 B2 C2 B3 C3 and B1 B2 B3 C1 C2 C3; expected one)",
            line, formula, is_plausible(in_order) ? "both" : "none");
    }
}

void SeqGlasses::define(int line, const std::string& key, const SeqWords& words) {
    if (key == "PWL") {
        wavelengths_nm_.clear();
        for (std::size_t i = 1; i < words.size(); ++i)
            wavelengths_nm_.push_back(seq_number(file_, line, words, i, "wavelength"));
    } else {
        // Reads the definition of a glass. If it is invalid, only the reason is stored. It is reported later
        // if a surface uses the glass.
        std::vector<double> n;
        const bool named = words.size() > 1 && !parse_number(words[1]);
        const std::string formula = named ? upper_case(words[1]) : "";
        for (std::size_t i = named ? 2 : 1; i < words.size(); ++i) {
            const auto value = parse_number(words[i]);
            if (!value || !std::isfinite(*value)) {
                unread_[key] = fmt::format("line {} is not understood (got {}; expected numbers)", line,
                                           excerpt(words[i]));
                return;
            }
            n.push_back(*value);
        }
        if (named) {
            define_by_formula(line, key, formula, std::move(n));
            return;
        }
        if (n.size() != wavelengths_nm_.size() || n.empty()) {
            unread_[key] = fmt::format("line {} has {} indices (expected {}, as PWL)", line, n.size(),
                                       wavelengths_nm_.size());
            return;
        }
        const std::size_t middle = n.size() / 2, last = n.size() - 1;
        const std::array<double, 3> nm{wavelengths_nm_[0], wavelengths_nm_[middle], wavelengths_nm_[last]};
        const bool spread = n.size() >= 3 && nm[0] > 0 && nm[1] > 0 && nm[2] > 0 && nm[0] != nm[1] &&
                            nm[1] != nm[2] && nm[0] != nm[2];
        private_[key] = spread ? Glass::three_points(nm, {n[0], n[middle], n[last]}, key)
                               : Glass::constant(n[middle], key);
    }
}

}  // namespace postlens
