// Reads the lens tables of pbrt. Each line describes one surface, from the front of the lens to the film:
// "radius thickness index diameter".
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "lens/prescription/formats.h"

namespace postlens {

namespace {

/// Decides which surfaces with radius 0 in a .dat lens file are planes. Normally, the radius 0 marks the
/// aperture stop, so `is_stop` was set for each of them. But some files also write plane glass surfaces with
/// the radius 0. These refract, and a stop does not.
void find_planes(std::vector<Surface>& surfaces, double wavelength_nm) {
    const auto refracts = [&](std::size_t i) {
        const double before = i == 0 ? 1 : surfaces[i - 1].glass.index(wavelength_nm);
        return surfaces[i].glass.index(wavelength_nm) != before;
    };
    std::size_t rows = 0, even = 0;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!surfaces[i].is_stop) continue;
        ++rows;
        if (!refracts(i)) ++even;
    }
    // If several rows have radius 0 and exactly one of them has the same medium on both sides, this one is
    // the aperture stop. The others are plane glass surfaces.
    if (rows < 2 || even != 1) return;
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        surfaces[i].is_stop = surfaces[i].is_stop && !refracts(i);
}

}  // namespace

Prescription parse_dat(const std::string& text, const std::string& file) {
    Prescription lens;
    lens.file = file;
    Glass before;
    for (const TextLine& line : lines_of(text)) {
        const std::string_view content = line.text.substr(0, line.text.find('#'));
        const auto words = words_of(content);
        if (words.empty()) {
            // The first comment of the file is the name of the lens.
            const std::size_t at = line.text.find_first_not_of("# \t");
            if (lens.name.empty() && lens.surfaces.empty() && at != std::string_view::npos) {
                const std::string_view words_only = line.text.substr(at);
                lens.name = words_only.substr(
                    0, std::min<std::size_t>(words_only.find_last_not_of(" \t\"") + 1, 200));
            }
            continue;
        }
        // A line with a single number, above the table of surfaces, gives the focal length.
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
        const bool is_plane = words[0] == "inf" || words[0] == "Infinity" || words[0] == "INF";
        const double radius = is_plane ? std::numeric_limits<double>::infinity()
                                       : number_in(file, line.number, words[0], "radius");
        const double index = number_in(file, line.number, words[2], "index");
        const double diameter = number_in(file, line.number, words[3], "clear diameter");
        Surface s;
        s.line = line.number;
        s.is_stop = radius == 0;
        s.curvature_per_mm = radius == 0 ? 0 : 1 / radius;
        s.thickness_mm = number_in(file, line.number, words[1], "thickness");
        s.clear_radius_mm = 0.5 * diameter;
        // If the file gives the aperture stop a refractive index of 0, the stop lies in the medium in front
        // of it.
        s.glass = s.is_stop && index == 0 ? before : Glass::constant(index);
        before = s.glass;
        lens.surfaces.push_back(s);
    }
    find_planes(lens.surfaces, lens.wavelength_nm);
    if (!lens.surfaces.empty() && lens.surfaces.back().thickness_mm != 0) {
        lens.film_distance_mm = lens.surfaces.back().thickness_mm;
    }
    return lens;
}

}  // namespace postlens
