// Reads the text format of Zemax. Each surface, from object to image, is a block of lines that begins with
// SURF.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "core/text.h"
#include "lens/prescription/formats.h"
#include "lens/prescription/glass_catalogue.h"

namespace postlens {
namespace {

using Words = std::vector<std::string_view>;

struct ZmxSurface {
    Surface surface;
    double thickness = 0;                   ///< in the file's unit; may be infinite
    std::optional<double> aperture_radius;  ///< from CLAP or FLAP, which block light
    std::string_view type = "STANDARD";
    std::map<int, double> parameters;  ///< values of PARM lines, by number
    bool has_diameter = false;
};

class ZmxReader {
  public:
    explicit ZmxReader(const std::string& file) { lens_.file = file; }

    void line(const TextLine& at, const Words& words) {
        at_ = at;
        const std::string_view key = words[0];
        if (key == "SURF") {
            check_surface_count(lens_.file, at.number, surfaces_.size() < 2 ? 0 : surfaces_.size() - 2);
            surfaces_.emplace_back();
            surfaces_.back().surface.line = at.number;
        } else if (!surfaces_.empty() && surface_line(key, words)) {
            return;
        } else {
            system_line(key, words);
        }
    }

    Prescription finish();

  private:
    [[nodiscard]] double number(const Words& words, std::size_t i, std::string_view what) const {
        if (i >= words.size()) {
            fail(ExitCode::invalid_input, "{}:{}: {} is missing (got {} words; expected {})", lens_.file,
                 at_.number, what, words.size(), i + 1);
        }
        return number_in(lens_.file, at_.number, words[i], what);
    }
    [[noreturn]] void unsupported(std::string_view what) const {
        fail(ExitCode::invalid_input,
             "{}:{}: {} is not supported (expected apertures that are circles about the axis)", lens_.file,
             at_.number, what);
    }
    [[nodiscard]] int whole(const Words& words, std::size_t i, std::string_view what) const {
        const double value = number(words, i, what);
        if (value != std::floor(value) || std::abs(value) > 1e6) {
            fail(ExitCode::invalid_input, "{}:{}: {} is not whole (got {}; expected a whole number)",
                 lens_.file, at_.number, what, value);
        }
        return static_cast<int>(value);
    }
    bool surface_line(std::string_view key, const Words& words);
    void system_line(std::string_view key, const Words& words);
    void glass(const Words& words);
    void unit(const Words& words);
    void finish_surface(ZmxSurface& from);

    Prescription lens_;
    TextLine at_;
    std::vector<ZmxSurface> surfaces_;
    std::map<int, double> wavelengths_nm_;
    int primary_ = 1;
    double mm_per_unit_ = 1;
    bool by_stop_size_ = false;
    bool fields_are_angles_ = true;  ///< false if the fields are heights
};

void ZmxReader::glass(const Words& words) {
    Surface& s = surfaces_.back().surface;
    const std::string_view name = words.size() > 1 ? words[1] : std::string_view();
    if (name == "MIRROR") {
        fail(ExitCode::invalid_input, "{}:{}: mirrors are not supported (expected lenses only)", lens_.file,
             at_.number);
    }
    if (auto known = find_glass(name)) {
        s.glass = *std::move(known);
        return;
    }
    const double nd = words.size() > 4 ? number(words, 4, "nd") : 0;
    const double vd = words.size() > 5 ? number(words, 5, "Vd") : 0;
    // If the catalogue does not contain the glass, the file's index nd and Abbe number Vd define it. But 1.5
    // and 40 are usually placeholders of Zemax, which define no glass.
    const bool is_model = words.size() > 2 && words[2] == "1", is_placeholder = nd == 1.5 && vd == 40;
    if (nd <= 0 || (is_placeholder && !is_model)) {
        s.glass = glass_by_name(lens_.file, at_.number, name);
        return;
    }
    s.glass =
        nd >= 1 && vd > 0 ? Glass::abbe(nd, vd, std::string(name)) : Glass::constant(nd, std::string(name));
    if (!is_model) {
        lens_.notes.push_back(fmt::format(
            "{}:{}: the catalogue does not contain glass {}: the nd {:.6g} and Vd {:.4g} of the line count",
            lens_.file, at_.number, excerpt(name), nd, vd));
    }
}

bool ZmxReader::surface_line(std::string_view key, const Words& words) {
    ZmxSurface& s = surfaces_.back();
    if (key == "STOP") {
        s.surface.is_stop = true;
    } else if (key == "TYPE") {
        s.type = words.size() > 1 ? words[1] : std::string_view();
        if (s.type != "STANDARD" && s.type != "EVENASPH") {
            fail(ExitCode::invalid_input,
                 "{}:{}: this type of surface is not supported (got {}; expected STANDARD or EVENASPH)",
                 lens_.file, at_.number, excerpt(s.type));
        }
    } else if (key == "CURV") {
        s.surface.curvature_per_mm = number(words, 1, "curvature");
    } else if (key == "CONI") {
        s.surface.conic = number(words, 1, "conic constant");
    } else if (key == "PARM") {
        s.parameters[whole(words, 1, "number of the parameter")] = number(words, 2, "parameter");
    } else if (key == "DISZ") {
        const bool infinite = words.size() > 1 && (words[1] == "INFINITY" || words[1] == "Infinity");
        s.thickness = infinite ? HUGE_VAL : number(words, 1, "thickness");
    } else if (key == "GLAS") {
        glass(words);
    } else if (key == "CLAP" || key == "FLAP") {
        // In ZMX lens files, CLAP and FLAP describe a ring-shaped opening by its inner and outer radius. Only
        // an inner radius of 0 is supported.
        if (number(words, 1, "inner radius") > 0) unsupported("a ring of " + std::string(key));
        s.aperture_radius = number(words, 2, "outer radius");
    } else if (key == "OBSC" || key == "SQAP" || key == "SQOB" || key == "ELAP" || key == "ELOB" ||
               key == "SPID" || key == "UDAD" || key == "UDAP" || key == "UDOB") {
        unsupported(key);
    } else if (key == "OBDC") {
        if (number(words, 1, "decentre") != 0 || number(words, 2, "decentre") != 0) unsupported(key);
    } else if (key == "DIAM") {
        const double radius = number(words, 1, "semi-diameter");
        if (radius != 0) {
            s.surface.clear_radius_mm = radius;
            s.has_diameter = true;
        }
    } else {
        return false;
    }
    return true;
}

void ZmxReader::unit(const Words& words) {
    static const std::map<std::string_view, double> mm{{"MM", 1},      {"CM", 10},      {"IN", 25.4},
                                                       {"INCH", 25.4}, {"METER", 1000}, {"M", 1000}};
    const std::string_view word = words.size() > 1 ? words[1] : std::string_view();
    const auto found = mm.find(word);
    if (found == mm.end()) {
        fail(ExitCode::invalid_input, "{}:{}: unknown unit of length (got {}; expected MM, CM, IN or METER)",
             lens_.file, at_.number, excerpt(word));
    }
    mm_per_unit_ = found->second;
}

void ZmxReader::system_line(std::string_view key, const Words& words) {
    if (key == "NAME" && words.size() > 1) {
        const std::string_view rest =
            at_.text.substr(static_cast<std::size_t>(words[1].data() - at_.text.data()));
        lens_.name = rest.substr(0, 200);
    } else if (key == "UNIT") {
        unit(words);
    } else if (key == "ENPD") {
        lens_.entrance_pupil_diameter_mm = number(words, 1, "entrance pupil's diameter");
    } else if (key == "FNUM") {
        lens_.f_number = number(words, 1, "f-number");
    } else if (key == "FLOA") {
        by_stop_size_ = true;
    } else if (key == "WAVM") {
        wavelengths_nm_[whole(words, 1, "number of the wavelength")] = 1000 * number(words, 2, "wavelength");
    } else if (key == "PWAV") {
        primary_ = whole(words, 1, "number of the primary wavelength");
    } else if (key == "YFLN" && words.size() > 1) {
        for (std::size_t i = 1; i < words.size(); ++i) {
            const double angle = number(words, i, "field");
            if (angle != 0) lens_.field_angles_deg.push_back(angle);
        }
    } else if (key == "FTYP" && words.size() > 1) {
        fields_are_angles_ = whole(words, 1, "field type") == 0;
    }
}

void ZmxReader::finish_surface(ZmxSurface& from) {
    Surface& s = from.surface;
    s.curvature_per_mm /= mm_per_unit_;
    s.thickness_mm = from.thickness * mm_per_unit_;
    if (from.aperture_radius) s.clear_radius_mm = *from.aperture_radius;
    s.clear_radius_mm *= mm_per_unit_;
    if (!from.aperture_radius && !s.is_stop && s.glass.is_air() && s.curvature_per_mm == 0 &&
        (lens_.surfaces.empty() || lens_.surfaces.back().glass.is_air())) {
        // If a plane surface has air on both sides and the file states no aperture for it, it is only a
        // reference plane and blocks no light. The diameter that the file states for it is therefore ignored.
        s.clear_radius_mm = HUGE_VAL;
    }
    if (from.type == "EVENASPH") {
        double power = mm_per_unit_;
        for (std::size_t i = 0; i < 8; ++i) {
            const auto found = from.parameters.find(static_cast<int>(i) + 1);
            // Converts the coefficients of an asphere to mm. In the file's unit of length, which is U mm
            // (`mm_per_unit_`), the sag is a sum of terms a_i r^(2i). Therefore, the coefficient for mm is
            // a_i U / U^(2i).
            power /= mm_per_unit_ * mm_per_unit_;
            if (found != from.parameters.end()) s.asphere[i] = found->second * power;
        }
    }
    lens_.surfaces.push_back(s);
}

Prescription ZmxReader::finish() {
    if (surfaces_.size() < 3) {
        fail(ExitCode::invalid_input,
             "{}: too few surfaces (got {}; expected the object, at least one of the lens and the image)",
             lens_.file, surfaces_.size());
    }
    check_object_medium(lens_.file, surfaces_.front().surface);
    const double object = surfaces_.front().thickness * mm_per_unit_;
    if (std::isfinite(object) && object < 1e9) lens_.object_distance_mm = object;
    for (std::size_t i = 1; i + 1 < surfaces_.size(); ++i) finish_surface(surfaces_[i]);
    const double film = lens_.surfaces.back().thickness_mm;
    if (film != 0) lens_.film_distance_mm = film;
    if (by_stop_size_) {
        lens_.entrance_pupil_diameter_mm.reset();
        lens_.f_number.reset();
    } else if (lens_.entrance_pupil_diameter_mm) {
        *lens_.entrance_pupil_diameter_mm *= mm_per_unit_;
        lens_.f_number.reset();
    }
    // The fields in a .zmx file are positions of object points, either angles or heights. All were stored as
    // angles first, because the key FTYP, which tells the kind, may follow them. If they are heights, they
    // are discarded.
    if (!fields_are_angles_) lens_.field_angles_deg.clear();
    const auto wavelength = wavelengths_nm_.find(primary_);
    if (wavelength != wavelengths_nm_.end()) lens_.wavelength_nm = wavelength->second;
    return std::move(lens_);
}

}  // namespace

Prescription parse_zmx(const std::string& text, const std::string& file) {
    ZmxReader reader(file);
    for (const TextLine& line : lines_of(text)) {
        const auto words = words_of(line.text);
        if (!words.empty()) reader.line(line, words);
    }
    return reader.finish();
}

}  // namespace postlens
