// Reads CODE V sequence files, which are lists of commands that define a lens.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <map>

#include "core/error.h"
#include "core/text.h"
#include "lens/prescription/formats.h"
#include "lens/prescription/seq_glasses.h"
#include "lens/prescription/seq_text.h"

namespace postlens {
namespace {

class SeqReader {
  public:
    explicit SeqReader(const std::string& file) : glasses_(file) { lens_.file = file; }
    /// Reads one command of the CODE V lens file. The file is read in two passes, because a command may use a
    /// glass that is defined only later. In the first pass, `glasses` is true, and only glass definitions are
    /// read. In the second pass, all other commands are read.
    void command(int line, const SeqWords& words, bool glasses);
    Prescription finish();

  private:
    [[noreturn]] void unsupported(std::string_view what) const { seq_unsupported(lens_.file, line_, what); }
    [[nodiscard]] double number(const SeqWords& words, std::size_t i, std::string_view what) const {
        return seq_number(lens_.file, line_, words, i, what);
    }
    Surface& addressed(const SeqWords& words, std::size_t& next);
    void begin_surface(const std::string& key, const SeqWords& words);
    bool surface_command(const std::string& key, const SeqWords& words);
    void system_command(const std::string& key, const SeqWords& words);
    void clear_radius(const SeqWords& words);

    Prescription lens_;
    int line_ = 0;
    bool by_radius_ = false;
    double mm_per_unit_ = 1;
    std::size_t reference_ = SIZE_MAX;  ///< SIZE_MAX if not given; CODE V then uses the middle one
    std::vector<double> wavelengths_nm_;
    std::vector<Surface> all_;  // object, lens surfaces, image
    std::size_t current_ = 0;
    bool has_image_ = false;
    bool in_private_ = false;
    SeqGlasses glasses_;
};

// Returns the surface to which a CODE V command refers: the one that it names, as in "S3", or else the one
// that the file described last.
Surface& SeqReader::addressed(const SeqWords& words, std::size_t& next) {
    std::size_t at = current_;
    if (next < words.size() && words[next].size() > 1 && std::toupper(words[next][0]) == 'S') {
        const std::string which = upper_case(words[next].substr(1));
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

void SeqReader::begin_surface(const std::string& key, const SeqWords& words) {
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
    if (words.size() > 3) s.glass = glasses_.find(line_, words[3]);
    all_.push_back(s);
    current_ = all_.size() - 1;
}

bool SeqReader::surface_command(const std::string& key, const SeqWords& words) {
    static const std::map<std::string, std::size_t> terms{{"A", 1}, {"B", 2}, {"C", 3}, {"D", 4}, {"E", 5},
                                                          {"F", 6}, {"G", 7}, {"H", 8}, {"J", 9}};
    static const std::vector<std::string> refused{"XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", "DAR", "BEN",
                                                  "REX", "REY", "ELX", "ELY", "GRT", "DIF", "CYL", "YTO",
                                                  "AAS", "XTO", "SPS", "INR", "NSS", "CUX", "RDX", "SPL",
                                                  "HOE", "FRN", "DEL", "INS", "REV", "SCA"};
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
        if (next < words.size()) s.glass = glasses_.find(line_, words[next]);
    } else if (key == "K") {
        Surface& s = addressed(words, next);
        s.conic = number(words, next, "conic constant");
    } else if (key == "RMD") {
        static_cast<void>(addressed(words, next));
        if (next < words.size() && upper_case(words[next]) != "REFR")
            unsupported("mirrors are not supported");
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

// Reads the CODE V command CIR, which states the clear radius of a surface. Its form is CIR [Sk] [Zi]
// [CLR|EDG|OBS|HOL] radius, where Sk selects the surface. The words before the radius may be in any order.
void SeqReader::clear_radius(const SeqWords& words) {
    std::size_t next = 1;
    Surface* s = &addressed(words, next);
    for (; next < words.size() && !parse_number(words[next]); ++next) {
        const std::string word = upper_case(words[next]);
        if (word == "OBS" || word == "HOL") unsupported(fmt::format("CIR {} is not supported", word));
        if (word[0] == 'S') {
            s = &addressed(words, next);
            --next;
        }
    }
    // Light must pass both the glass edge (EDG) and the clear aperture (CLR), so the smaller radius counts.
    s->clear_radius_mm = std::min(s->clear_radius_mm, number(words, next, "clear radius"));
}

void SeqReader::system_command(const std::string& key, const SeqWords& words) {
    if (key == "RDM") {
        // After the commands RDM or "RDM Y", the file describes surfaces by their radii of curvature. After
        // "RDM N", it describes them by curvatures (1 / radius).
        by_radius_ = words.size() < 2 || upper_case(words[1]) != "N";
    } else if (key.starts_with("TIT")) {
        if (words.size() > 1) lens_.name = std::string(words[1].substr(0, 200));
    } else if (key == "EPD") {
        lens_.entrance_pupil_diameter_mm = number(words, 1, "entrance pupil's diameter");
    } else if (key == "FNO") {
        lens_.f_number = number(words, 1, "f-number");
    } else if (key == "DIM") {
        static const std::map<std::string, double> mm{{"M", 1},   {"MM", 1},   {"C", 10},
                                                      {"CM", 10}, {"I", 25.4}, {"IN", 25.4}};
        const auto found = mm.find(words.size() > 1 ? upper_case(words[1]) : "");
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
    // All other CODE V commands are ignored. They state, for example, weights or settings of displays, and do
    // not affect the shape of the lens.
}

void SeqReader::command(int line, const SeqWords& words, bool glasses) {
    line_ = line;
    const std::string key = upper_case(words[0]);
    if (key == "PRV") {
        in_private_ = true;
    } else if (in_private_ && (key == "END" || !glasses)) {
        if (key == "END") in_private_ = false;
    } else if (in_private_) {
        glasses_.define(line_, key, words);
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
    check_object_medium(lens_.file, all_.front());
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
    // The film distance is the sum of two thicknesses in the file: that of the last lens surface, and that of
    // the image surface, `all_.back()`. CODE V uses the thickness of the image surface to store the defocus.
    const double film = lens_.surfaces.back().thickness_mm + all_.back().thickness_mm * mm_per_unit_;
    if (film != 0) lens_.film_distance_mm = film;
    // If no command defines the stop, CODE V uses the first surface.
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
    const std::vector<std::pair<int, std::string>> commands = seq_commands(text, file);
    // Glasses are read first, because their definition may follow the surfaces that use them.
    for (const bool glasses : {true, false}) {
        for (const auto& [number, command] : commands) reader.command(number, words_of(command), glasses);
    }
    return reader.finish();
}

}  // namespace postlens
