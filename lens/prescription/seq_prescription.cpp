// Reads CODE V sequence files: lists of the commands that define a lens.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/text.h"
#include "lens/prescription/formats.h"
#include "lens/prescription/glass_catalogue.h"

namespace postlens {
namespace {

using Words = std::vector<std::string_view>;

std::string upper(std::string_view word) {
    std::string out(word);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return out;
}

// Removes the comment of a line, which begins at a ! outside quotes.
std::string_view without_remark(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quote != 0) {
            if (line[i] == quote) quote = 0;
        } else if (line[i] == '"' || line[i] == '\'') {
            quote = line[i];
        } else if (line[i] == '!') {
            return line.substr(0, i);
        }
    }
    return line;
}

// Splits a line into commands at the semicolons outside quotes.
std::vector<std::string_view> commands_of(std::string_view line) {
    std::vector<std::string_view> out;
    char quote = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i == line.size() || (quote == 0 && line[i] == ';')) {
            out.push_back(line.substr(begin, i - begin));
            begin = i + 1;
        } else if (quote != 0) {
            if (line[i] == quote) quote = 0;
        } else if (line[i] == '"' || line[i] == '\'') {
            quote = line[i];
        }
    }
    return out;
}

class SeqReader {
  public:
    explicit SeqReader(const std::string& file) { lens_.file = file; }
    /// Reads a command. With `glasses`, reads only definitions of private glasses, otherwise all others.
    void command(int line, const Words& words, bool glasses);
    Prescription finish();

  private:
    [[noreturn]] void unsupported(std::string_view what) const {
        fail(ExitCode::invalid_input, "{}:{}: {} (expected a lens of centred surfaces)", lens_.file, line_,
             what);
    }
    [[nodiscard]] double number(const Words& words, std::size_t i, std::string_view what) const {
        if (i >= words.size()) {
            fail(ExitCode::invalid_input, "{}:{}: {} is missing (got {} words; expected {})", lens_.file,
                 line_, what, words.size(), i + 1);
        }
        return number_in(lens_.file, line_, words[i], what);
    }
    Surface& addressed(const Words& words, std::size_t& next);
    void begin_surface(const std::string& key, const Words& words);
    bool surface_command(const std::string& key, const Words& words);
    void system_command(const std::string& key, const Words& words);
    void private_glass(const std::string& key, const Words& words);
    void private_formula(const std::string& key, const std::string& formula, std::vector<double> terms);
    void clear_radius(const Words& words);
    [[nodiscard]] Glass glass(std::string_view word) const;

    Prescription lens_;
    int line_ = 0;
    bool by_radius_ = false;
    double mm_per_unit_ = 1;
    std::size_t reference_ = SIZE_MAX;  ///< SIZE_MAX: not stated, CODE V uses the middle one
    std::vector<double> wavelengths_nm_;
    std::vector<Surface> all_;  // object, lens surfaces, image
    std::size_t current_ = 0;
    bool has_image_ = false;
    bool in_private_ = false;
    std::vector<double> private_nm_;
    std::map<std::string, Glass> private_;
    std::map<std::string, std::string> unread_;  ///< private glasses that could not be read, and the reason
};

// Finds the surface that a command applies to: that of "S3" after the command, else the latest surface.
Surface& SeqReader::addressed(const Words& words, std::size_t& next) {
    std::size_t at = current_;
    if (next < words.size() && words[next].size() > 1 && std::toupper(words[next][0]) == 'S') {
        const std::string which = upper(words[next].substr(1));
        if (which == "O") {
            at = 0;
            ++next;
        } else if (which == "I") {
            at = all_.empty() ? 0 : all_.size() - 1;
            ++next;
        } else if (const auto index = parse_number(which)) {
            if (!(*index >= 0 && *index < static_cast<double>(all_.size())) || *index != std::floor(*index)) {
                fail(ExitCode::invalid_input, "{}:{}: no such surface (got {}; expected S0 to S{})",
                     lens_.file, line_, excerpt(words[next]), all_.empty() ? 0 : all_.size() - 1);
            }
            at = static_cast<std::size_t>(*index);
            ++next;
        }
    }
    if (at >= all_.size()) {
        fail(ExitCode::invalid_input, "{}:{}: this command needs a surface before it (expected SO or S)",
             lens_.file, line_);
    }
    return all_[at];
}

// Finds a glass by its catalogue name, the name of a private glass, or a code of nd and Vd: "517642",
// "517.642", "516800.641700" or "1.5168:64.17".
Glass SeqReader::glass(std::string_view word) const {
    const std::string name = upper(word);
    if (name == "AIR") return {};
    if (name == "REFL") unsupported("mirrors are not supported");
    if (const auto own = private_.find(name); own != private_.end()) return own->second;
    if (const auto why = unread_.find(name); why != unread_.end()) {
        fail(ExitCode::invalid_input, "{}:{}: private glass {}: {}", lens_.file, line_, excerpt(name),
             why->second);
    }
    if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
        const double nd = number_in(lens_.file, line_, std::string_view(name).substr(0, colon), "nd");
        const double vd = number_in(lens_.file, line_, std::string_view(name).substr(colon + 1), "Vd");
        if (vd > 0) return Glass::abbe(nd, vd, name);
    }
    // Digits before the dot are the decimals of nd = 1.xxx. Digits after the dot are Vd, with two digits
    // before its decimal point.
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
    return glass_by_name(lens_.file, line_, word);
}

void SeqReader::begin_surface(const std::string& key, const Words& words) {
    if (has_image_) {
        fail(ExitCode::invalid_input, "{}:{}: a surface behind the image (got {}; expected SI last)",
             lens_.file, line_, key);
    }
    if (key == "SO") all_.clear();
    if (key == "SI") has_image_ = true;
    if (key == "S" && all_.empty()) all_.emplace_back();  // a missing object surface means infinity
    check_surface_count(lens_.file, line_, all_.size() < 2 ? 0 : all_.size() - 2);
    Surface s;
    s.line = line_;
    const double shape = words.size() > 1 ? number(words, 1, by_radius_ ? "radius" : "curvature") : 0;
    s.curvature_per_mm = by_radius_ ? (shape == 0 ? 0 : 1 / shape) : shape;
    s.thickness_mm = words.size() > 2 ? number(words, 2, "thickness") : 0;
    if (words.size() > 3) s.glass = glass(words[3]);
    all_.push_back(s);
    current_ = all_.size() - 1;
}

bool SeqReader::surface_command(const std::string& key, const Words& words) {
    static const std::map<std::string, std::size_t> terms{{"A", 1}, {"B", 2}, {"C", 3}, {"D", 4}, {"E", 5},
                                                          {"F", 6}, {"G", 7}, {"H", 8}, {"J", 9}};
    static const std::vector<std::string> refused{"XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", "DAR",
                                                  "BEN", "REX", "REY", "ELX", "ELY", "GRT", "DIF",
                                                  "CYL", "YTO", "AAS", "XTO", "SPS", "INR", "NSS"};
    std::size_t next = 1;
    if (key == "STO") {
        addressed(words, next).is_stop = true;
    } else if (key == "RDY" || key == "CUY") {
        Surface& s = addressed(words, next);
        const double value = number(words, next, "radius or curvature");
        s.curvature_per_mm = key == "CUY" ? value : value == 0 ? 0 : 1 / value;
    } else if (key == "THI") {
        Surface& s = addressed(words, next);
        s.thickness_mm = number(words, next, "thickness");
    } else if (key == "GLA") {
        Surface& s = addressed(words, next);
        if (next < words.size()) s.glass = glass(words[next]);
    } else if (key == "K") {
        Surface& s = addressed(words, next);
        s.conic = number(words, next, "conic constant");
    } else if (key == "CIR") {
        clear_radius(words);
    } else if (key == "ADX" || key == "ADY" || key == "ARO") {
        static_cast<void>(addressed(words, next));
        if (number(words, next, "shift of the aperture") != 0)
            unsupported(fmt::format("command {} is not supported", key));
    } else if (const auto term = terms.find(key); term != terms.end()) {
        Surface& s = addressed(words, next);
        s.asphere[term->second] = number(words, next, "aspheric coefficient");
    } else if (std::find(refused.begin(), refused.end(), key) != refused.end()) {
        unsupported(fmt::format("command {} is not supported", key));
    } else {
        return false;
    }
    return true;
}

// True if a Sellmeier formula has an index between 1.2 and 4 and its poles below 0.32 or above 2 um, as
// glasses have.
bool is_plausible(const std::array<double, 6>& terms) {
    const double n = Glass::sellmeier(terms).index(d_line_nm);
    return n > 1.2 && n < 4 &&
           std::all_of(terms.begin() + 3, terms.end(), [](double c) { return c < 0.1 || c > 4; });
}

// Reads a private glass given by a formula. Missing coefficients are 0. Sellmeier coefficients occur in the
// orders B1 C1 B2 C2 B3 C3 and B1 B2 B3 C1 C2 C3. The order that gives a plausible glass is used; the formula
// is refused if both orders do, or neither.
void SeqReader::private_formula(const std::string& key, const std::string& formula,
                                std::vector<double> terms) {
    const bool laurent = formula == "LAU" || formula == "GML",
               sellmeier = formula == "STS" || formula == "GMS";
    if ((!laurent && !sellmeier) || terms.empty() || terms.size() > 6) {
        unread_[key] = fmt::format(
            "line {} is not understood (got the formula {} with {} coefficients; expected "
            "LAU or GML, STS or GMS, with up to 6, or indices)",
            line_, excerpt(formula), terms.size());
        return;
    }
    terms.resize(6, 0);
    const auto& t = terms;
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
            line_, formula, is_plausible(in_order) ? "both" : "none");
    }
}

// Reads CIR [Sk] [Zi] [CLR|EDG|OBS|HOL] radius, with the words in any order before the number. Light must
// pass within both the edge of the glass (EDG) and the clear aperture (CLR), so the smallest radius is used.
void SeqReader::clear_radius(const Words& words) {
    std::size_t next = 1;
    Surface* s = &addressed(words, next);
    for (; next < words.size() && !parse_number(words[next]); ++next) {
        const std::string word = upper(words[next]);
        if (word == "OBS" || word == "HOL") unsupported(fmt::format("CIR {} is not supported", word));
        if (word[0] == 'S') {
            s = &addressed(words, next);
            --next;
        }
    }
    s->clear_radius_mm = std::min(s->clear_radius_mm, number(words, next, "clear radius"));
}

void SeqReader::private_glass(const std::string& key, const Words& words) {
    if (key == "PWL") {
        private_nm_.clear();
        for (std::size_t i = 1; i < words.size(); ++i) private_nm_.push_back(number(words, i, "wavelength"));
    } else {
        // An unreadable private glass is an error only if a surface uses it, so the reason is kept until
        // then.
        std::vector<double> n;
        const bool named = words.size() > 1 && !parse_number(words[1]);
        const std::string formula = named ? upper(words[1]) : "";
        for (std::size_t i = named ? 2 : 1; i < words.size(); ++i) {
            const auto value = parse_number(words[i]);
            if (!value || !std::isfinite(*value)) {
                unread_[key] = fmt::format("line {} is not understood (got {}; expected numbers)", line_,
                                           excerpt(words[i]));
                return;
            }
            n.push_back(*value);
        }
        if (named) {
            private_formula(key, formula, std::move(n));
            return;
        }
        if (n.size() != private_nm_.size() || n.empty()) {
            unread_[key] = fmt::format("line {} has {} indices (expected {}, as PWL)", line_, n.size(),
                                       private_nm_.size());
            return;
        }
        const std::size_t middle = n.size() / 2, last = n.size() - 1;
        const std::array<double, 3> nm{private_nm_[0], private_nm_[middle], private_nm_[last]};
        const bool spread = n.size() >= 3 && nm[0] > 0 && nm[1] > 0 && nm[2] > 0 && nm[0] != nm[1] &&
                            nm[1] != nm[2] && nm[0] != nm[2];
        private_[key] = spread ? Glass::three_points(nm, {n[0], n[middle], n[last]}, key)
                               : Glass::constant(n[middle], key);
    }
}

void SeqReader::system_command(const std::string& key, const Words& words) {
    if (key == "RDM") {
        // The command RDM, alone or as "RDM Y", means that the file states radii of curvature. "RDM N" means
        // that it states curvatures.
        by_radius_ = words.size() < 2 || upper(words[1]) != "N";
    } else if (key.starts_with("TIT")) {
        if (words.size() > 1) lens_.name = std::string(words[1].substr(0, 200));
    } else if (key == "EPD") {
        lens_.entrance_pupil_diameter_mm = number(words, 1, "entrance pupil's diameter");
    } else if (key == "FNO") {
        lens_.f_number = number(words, 1, "f-number");
    } else if (key == "DIM") {
        static const std::map<std::string, double> mm{{"M", 1},   {"MM", 1},   {"C", 10},
                                                      {"CM", 10}, {"I", 25.4}, {"IN", 25.4}};
        const auto found = mm.find(words.size() > 1 ? upper(words[1]) : "");
        if (found == mm.end()) {
            fail(ExitCode::invalid_input, "{}:{}: unknown unit of length (got {}; expected M, C or I)",
                 lens_.file, line_, excerpt(words.size() > 1 ? words[1] : ""));
        }
        mm_per_unit_ = found->second;
    } else if (key == "WL") {
        wavelengths_nm_.clear();
        for (std::size_t i = 1; i < words.size(); ++i)
            wavelengths_nm_.push_back(number(words, i, "wavelength"));
    } else if (key == "REF") {
        const double value = number(words, 1, "number of the reference wavelength");
        if (!(value >= 1 && value <= 1000)) {
            fail(ExitCode::invalid_input,
                 "{}:{}: reference wavelength out of range (got {}; expected 1 or more)", lens_.file, line_,
                 value);
        }
        reference_ = static_cast<std::size_t>(value) - 1;
    } else if (key == "YAN") {
        lens_.field_angles_deg.clear();
        for (std::size_t i = 1; i < words.size(); ++i) {
            const double angle = number(words, i, "field angle");
            if (angle != 0) lens_.field_angles_deg.push_back(angle);
        }
    }
    // Other commands do not define the shape of the lens: weights, solves, vignetting, displays.
}

void SeqReader::command(int line, const Words& words, bool glasses) {
    line_ = line;
    const std::string key = upper(words[0]);
    if (key == "PRV") {
        in_private_ = true;
    } else if (in_private_ && (key == "END" || !glasses)) {
        if (key == "END") in_private_ = false;
    } else if (in_private_) {
        private_glass(key, words);
    } else if (glasses) {
        return;
    } else if (key == "SO" || key == "S" || key == "SI") {
        begin_surface(key, words);
    } else if (key.size() > 1 && key[0] == 'S' &&
               std::all_of(key.begin() + 1, key.end(),
                           [](unsigned char c) { return std::isdigit(c) != 0; })) {
        begin_surface("S", words);
    } else if (!surface_command(key, words)) {
        system_command(key, words);
    }
}

Prescription SeqReader::finish() {
    if (!has_image_ || all_.size() < 3) {
        fail(ExitCode::invalid_input,
             "{}: not a whole lens (got {} surfaces{}; expected SO, at least one S, and SI)", lens_.file,
             all_.size(), has_image_ ? "" : " and no image");
    }
    const double object = all_.front().thickness_mm * mm_per_unit_;
    if (object > 0 && object < 1e9) lens_.object_distance_mm = object;
    for (std::size_t i = 1; i + 1 < all_.size(); ++i) {
        Surface s = all_[i];
        double power = mm_per_unit_;
        for (double& a : s.asphere) {
            power /= mm_per_unit_ * mm_per_unit_;
            a *= power;
        }
        s.curvature_per_mm /= mm_per_unit_;
        s.thickness_mm *= mm_per_unit_;
        s.clear_radius_mm *= mm_per_unit_;
        lens_.surfaces.push_back(s);
    }
    // The thickness of the image surface is the defocus: the distance of the film from the image surface.
    const double film = lens_.surfaces.back().thickness_mm + all_.back().thickness_mm * mm_per_unit_;
    if (film != 0) lens_.film_distance_mm = film;
    // If no command states the stop, CODE V takes the first surface.
    if (std::none_of(lens_.surfaces.begin(), lens_.surfaces.end(),
                     [](const Surface& s) { return s.is_stop; })) {
        lens_.surfaces.front().is_stop = true;
    }
    if (lens_.entrance_pupil_diameter_mm) {
        *lens_.entrance_pupil_diameter_mm *= mm_per_unit_;
        lens_.f_number.reset();
    }
    if (reference_ < wavelengths_nm_.size()) {
        lens_.wavelength_nm = wavelengths_nm_[reference_];
    } else if (!wavelengths_nm_.empty()) {
        lens_.wavelength_nm = wavelengths_nm_[wavelengths_nm_.size() / 2];
    }
    return std::move(lens_);
}

}  // namespace

Prescription parse_seq(const std::string& text, const std::string& file) {
    SeqReader reader(file);
    std::vector<std::pair<int, std::string>> commands;
    std::string continued;
    for (const TextLine& line : lines_of(text)) {
        std::string_view content = without_remark(line.text);
        const std::size_t last = content.find_last_not_of(" \t");
        const bool goes_on = last != std::string_view::npos && content[last] == '&';
        if (goes_on) content = content.substr(0, last);
        if (continued.size() + content.size() > 100'000) {
            fail(ExitCode::invalid_input, "{}:{}: a command of more than 100000 characters", file,
                 line.number);
        }
        continued += content;
        continued += ' ';
        if (goes_on) continue;
        for (const std::string_view command : commands_of(continued)) {
            if (!words_of(command).empty()) commands.emplace_back(line.number, command);
        }
        continued.clear();
    }
    // Private glasses may be defined after the surfaces that use them, so they are read first.
    for (const bool glasses : {true, false}) {
        for (const auto& [number, command] : commands) reader.command(number, words_of(command), glasses);
    }
    return reader.finish();
}

}  // namespace postlens
