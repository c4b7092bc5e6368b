// Reads our own lens format (docs/lens_prescriptions.md).
#include <algorithm>
#include <array>
#include <map>

#include "core/toml_reader.h"
#include "lens/prescription/formats.h"

namespace postlens {
namespace {

using Name = std::string_view;
using Glasses = std::map<std::string, Glass, std::less<>>;

constexpr std::array<Name, 4> medium_keys{"index", "nd", "vd", "sellmeier"};

// Reads a medium (a glass or another material) from a table of a TOML lens file. Returns nothing if the table
// contains no key for a medium, such as "index" or "nd".
std::optional<Glass> medium(const TomlTable& table, const std::string& name) {
    table.refuse_both("index", "nd");
    table.refuse_both("index", "sellmeier");
    table.refuse_both("nd", "sellmeier");
    constexpr NumberRange index_range{.min = 1, .max = 5};
    if (const auto n = table.number("index", index_range)) return Glass::constant(*n, name);
    if (const auto terms = table.numbers("sellmeier", 6)) {
        std::array<double, 6> all{};
        std::copy(terms->begin(), terms->end(), all.begin());
        return Glass::sellmeier(all, name);
    }
    if (const auto nd = table.number("nd", index_range)) {
        return Glass::abbe(
            *nd, table.required(table.number("vd", {.min = 0, .max = 1000, .excludes_min = true}), "vd"),
            name);
    }
    if (table.has("vd")) table.fail_at("vd", "'vd' stands alone (expected 'nd' beside it)");
    return std::nullopt;
}

int line_of(const TomlTable& table) {
    const std::string place = table.line();  // has the form FILE:LINE
    return std::atoi(place.c_str() + place.rfind(':') + 1);
}

Glass read_glass(const TomlTable& table, const Glasses& own, const std::string& file, int line) {
    if (auto given = medium(table, "")) {
        if (table.has("glass"))
            table.fail_at("glass", "'glass' stands beside an index (expected one of them)");
        return *std::move(given);
    }
    const auto name = table.text("glass");
    if (!name || *name == "air") return {};
    if (const auto found = own.find(*name); found != own.end()) return found->second;
    return glass_by_name(file, line, *name);
}

Surface read_surface(const TomlTable& table, const Glasses& own, const std::string& file) {
    static constexpr std::array<Name, 9> known{
        "radius_mm",    "curvature_per_mm",     "conic", "even_asphere",
        "thickness_mm", "aperture_diameter_mm", "glass", "stop",
        "comment"};
    table.allow_only({known, medium_keys});
    table.refuse_both("radius_mm", "curvature_per_mm");
    Surface s;
    s.line = line_of(table);
    if (const auto radius = table.number("radius_mm", {.may_be_infinite = true})) {
        if (*radius == 0) table.fail_at("radius_mm", "'radius_mm' is 0 (expected inf for a plane)");
        s.curvature_per_mm = 1 / *radius;
    }
    s.curvature_per_mm = table.number("curvature_per_mm").value_or(s.curvature_per_mm);
    s.conic = table.number("conic").value_or(0);
    const auto terms = table.number_list("even_asphere");
    if (terms.size() > asphere_terms) {
        table.fail_at("even_asphere", "'even_asphere' has too many terms (got {}; expected at most {})",
                      terms.size(), asphere_terms);
    }
    std::copy(terms.begin(), terms.end(), s.asphere.begin());
    s.thickness_mm = table.number("thickness_mm", {.min = 0}).value_or(0);
    if (const auto diameter = table.number("aperture_diameter_mm", {.min = 0, .excludes_min = true})) {
        s.clear_radius_mm = 0.5 * *diameter;
    }
    s.is_stop = table.flag("stop").value_or(false);
    s.glass = read_glass(table, own, file, s.line);
    return s;
}

void read_lens(const TomlTable& table, Prescription& lens) {
    static constexpr std::array<Name, 9> known{"name",
                                               "source",
                                               "wavelength_nm",
                                               "film_distance_mm",
                                               "object_distance_mm",
                                               "entrance_pupil_diameter_mm",
                                               "f_number",
                                               "stated_focal_length_mm",
                                               "field_deg"};
    table.allow_only({known});
    table.refuse_both("entrance_pupil_diameter_mm", "f_number");
    constexpr NumberRange positive{.min = 0, .excludes_min = true};
    lens.name = table.text("name").value_or("");
    lens.source = table.text("source").value_or("");
    lens.wavelength_nm = table.number("wavelength_nm", {.min = 100, .max = 1e5}).value_or(d_line_nm);
    lens.film_distance_mm = table.number("film_distance_mm", positive);
    lens.object_distance_mm = table.number("object_distance_mm", positive);
    lens.entrance_pupil_diameter_mm = table.number("entrance_pupil_diameter_mm", positive);
    lens.f_number = table.number("f_number", positive);
    lens.stated_focal_length_mm = table.number("stated_focal_length_mm");
    lens.field_angles_deg = table.number_list("field_deg", {.min = -89, .max = 89});
}

}  // namespace

Prescription parse_lens_toml(const std::string& text, const std::string& file) {
    // Counts the [[surface]] tables before parsing, because the parser would run out of memory on millions of
    // them.
    const auto lines = lines_of(text);
    std::size_t tables = 0;
    for (const TextLine& line : lines) {
        const std::size_t at = line.text.find_first_not_of(" \t");
        if (at == std::string_view::npos || !line.text.substr(at).starts_with("[[surface]]")) continue;
        check_surface_count(file, line.number, tables++);
    }
    if (text.size() > 4'000'000) {
        fail(ExitCode::invalid_input, "{}: too large (got {} bytes; expected at most 4000000)", file,
             text.size());
    }
    const toml::table document = parse_toml(text, file);
    const TomlTable root(file, document, "prescription");
    static constexpr std::array<Name, 3> known{"lens", "glass", "surface"};
    root.allow_only({known});
    Prescription lens;
    lens.file = file;
    if (const auto table = root.table("lens")) read_lens(*table, lens);
    Glasses own;
    if (const auto table = root.table("glass")) {
        const toml::table* names = document["glass"].as_table();
        for (const auto& [key, value] : *names) {
            const std::string name(key.str());
            const TomlTable one = table->required(table->table(name), name);
            one.allow_only({medium_keys});
            auto given = medium(one, name);
            if (!given) one.fail_here("says no index (expected 'index', 'nd' and 'vd', or 'sellmeier')");
            own.emplace(name, *std::move(given));
        }
    }
    for (const TomlTable& table : root.tables("surface", "surface")) {
        check_surface_count(file, line_of(table), lens.surfaces.size());
        lens.surfaces.push_back(read_surface(table, own, file));
    }
    if (!lens.film_distance_mm && !lens.surfaces.empty() && lens.surfaces.back().thickness_mm > 0) {
        lens.film_distance_mm = lens.surfaces.back().thickness_mm;
    }
    return lens;
}

}  // namespace postlens
