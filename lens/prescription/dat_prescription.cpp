// pbrt's table: one surface a line, "radius thickness index diameter", from the front to the film.
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "lens/prescription/formats.h"

namespace postlens {

Prescription parse_dat(const std::string& text, const std::string& file) {
    Prescription lens;
    lens.file = file;
    Glass before;
    for (const TextLine& line : lines_of(text)) {
        const std::string_view content = line.text.substr(0, line.text.find('#'));
        const auto words = words_of(content);
        if (words.empty()) {
            // The first comment is what people call the lens by.
            const std::size_t at = line.text.find_first_not_of("# \t");
            if (lens.name.empty() && lens.surfaces.empty() && at != std::string_view::npos) {
                const std::string_view words_only = line.text.substr(at);
                lens.name = words_only.substr(
                    0, std::min<std::size_t>(words_only.find_last_not_of(" \t\"") + 1, 200));
            }
            continue;
        }
        // A number alone ahead of the table is the focal length that the file claims.
        if (words.size() == 1 && lens.surfaces.empty() && !lens.stated_focal_length_mm) {
            lens.stated_focal_length_mm = number_in(file, line.number, words[0], "focal length");
            continue;
        }
        if (words.size() != 4) {
            fail(ExitCode::invalid_input,
                 "{}:{}: not a row of the table (got {} words; expected radius, thickness, index and clear "
                 "diameter)",
                 file, line.number, words.size());
        }
        check_surface_count(file, line.number, lens.surfaces.size());
        const double radius = number_in(file, line.number, words[0], "radius");
        const double index = number_in(file, line.number, words[2], "index");
        const double diameter = number_in(file, line.number, words[3], "clear diameter");
        Surface s;
        s.line = line.number;
        s.is_stop = radius == 0;
        s.curvature_per_mm = radius == 0 ? 0 : 1 / radius;
        s.thickness_mm = number_in(file, line.number, words[1], "thickness");
        s.clear_radius_mm = 0.5 * diameter;
        // A stop's index may be left 0: it stands in what is before it.
        s.glass = s.is_stop && index == 0 ? before : Glass::constant(index);
        before = s.glass;
        lens.surfaces.push_back(s);
    }
    if (!lens.surfaces.empty() && lens.surfaces.back().thickness_mm != 0) {
        lens.film_distance_mm = lens.surfaces.back().thickness_mm;
    }
    return lens;
}

}  // namespace postlens
