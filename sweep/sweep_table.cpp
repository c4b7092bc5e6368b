#include "sweep/sweep_table.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/json_dump.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"') out.push_back('"');
        out.push_back(c);
    }
    return out + '"';
}

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json number(const std::optional<double>& value) {
    return value ? number(*value) : Json(nullptr);
}

std::string cell(const std::optional<double>& value) {
    return value ? fmt::format("{:.9g}", *value) : "";
}

Json row_json(const SweepTable& table, const SweepRow& row) {
    const SweepSetting& s = row.setting;
    Json coc = Json::array();
    for (std::size_t i = 0; i < row.coc_px.size(); ++i)
        coc.push_back({{"x", table.at[i].x}, {"y", table.at[i].y}, {"coc_px", number(row.coc_px[i])}});
    return {{"file", row.file},
            {"f_number", number(s.f_number)},
            {"focal_length_mm", s.focal_length_mm},
            {"focus_m", number(s.focus_m)},
            {"shutter_open_s", s.shutter ? Json(s.shutter->open_s) : Json(nullptr)},
            {"shutter_close_s", s.shutter ? Json(s.shutter->close_s) : Json(nullptr)},
            {"impulse", impulse_text(s.impulse)},
            {"method", row.method},
            {"depths", row.depths},
            {"views", row.views},
            {"at", coc},
            {"largest_coc_px", number(row.largest_coc_px)},
            {"in_focus_share", row.in_focus_share},
            {"sharpness", number(row.sharpness)},
            {"predicted_db", number(row.predicted_db)},
            {"seconds", row.seconds},
            {"kept", row.kept},
            {"settings_key", row.settings_key},
            {"picture_checksum", row.picture_checksum}};
}

std::optional<double> optional_number(const Json& json) {
    return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

SweepRow row_of(const Json& json) {
    SweepRow row;
    row.file = json.at("file").get<std::string>();
    row.method = json.at("method").get<std::string>();
    row.depths = json.at("depths").get<int>();
    row.views = json.at("views").get<int>();
    for (const Json& at : json.at("at")) row.coc_px.push_back(at.at("coc_px").get<double>());
    row.largest_coc_px = json.at("largest_coc_px").get<double>();
    row.in_focus_share = json.at("in_focus_share").get<double>();
    row.sharpness = optional_number(json.at("sharpness"));
    row.predicted_db = optional_number(json.at("predicted_db"));
    row.seconds = json.at("seconds").get<double>();
    row.settings_key = json.at("settings_key").get<std::string>();
    row.picture_checksum = json.at("picture_checksum").get<std::string>();
    row.kept = true;
    return row;
}

}  // namespace

std::string csv_text(const SweepTable& table) {
    std::string out = "file,f_number,focal_length_mm,focus_m,shutter_open_s,shutter_close_s,impulse,method";
    for (const glm::dvec2& at : table.at) out += fmt::format(",coc_px {:.6g} {:.6g}", at.x, at.y);
    out += ",largest_coc_px,in_focus_share,sharpness,predicted_db,seconds\n";
    for (const SweepRow& row : table.rows) {
        const SweepSetting& s = row.setting;
        out += quoted(row.file);
        const auto add = [&out](const std::optional<double>& v) { out.append(",").append(cell(v)); };
        for (const double v : {s.f_number, s.focal_length_mm, s.focus_m}) add(v);
        add(s.shutter ? std::optional(s.shutter->open_s) : std::nullopt);
        add(s.shutter ? std::optional(s.shutter->close_s) : std::nullopt);
        out.append(",").append(quoted(impulse_text(s.impulse))).append(",").append(row.method);
        for (const double coc_px : row.coc_px) add(coc_px);
        add(row.largest_coc_px);
        add(row.in_focus_share);
        add(row.sharpness);
        add(row.predicted_db);
        add(row.seconds);
        out += "\n";
    }
    return out;
}

std::string json_text(const SweepTable& table) {
    Json rows = Json::array();
    for (const SweepRow& row : table.rows) rows.push_back(row_json(table, row));
    Json all = {{"frame", table.frame}, {"coc_limit_px", table.coc_limit_px}, {"pictures", rows}};
    if (!table.part.empty()) all["part"] = Json::parse(table.part);
    return json_dump(all, 1) + "\n";
}

std::string name_in_json(const std::string& name) {
    return Json::parse(json_dump(Json(name))).get<std::string>();
}

std::map<std::string, SweepRow> rows_of_json(const std::string& text, const std::string& source) {
    std::map<std::string, SweepRow> out;
    try {
        const Json json = Json::parse(text);
        for (const Json& row : json.at("pictures")) {
            SweepRow r = row_of(row);
            std::string file = r.file;
            out.emplace(std::move(file), std::move(r));
        }
    } catch (const Json::exception&) {
        fail(ExitCode::invalid_input,
             "{}: is not what a sweep has left (expected that of an earlier run, or "
             "no --resume)",
             source);
    }
    return out;
}

}  // namespace postlens
