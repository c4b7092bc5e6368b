#include "chart/chart_page.h"

#include <cmath>
#include <fmt/format.h>

#include "chart/chart_runner.h"
#include "chart/html_text.h"
#include "chart/page_template.h"
#include "chart/pareto.h"
#include "core/json_dump.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Escapes '<', which could otherwise end the script element.
std::string script_safe(const std::string& json) {
    std::string out;
    for (const char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return out;
}

std::string replaced(const std::string& text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    return at == std::string::npos ? text : text.substr(0, at) + by + text.substr(at + what.size());
}

std::string what_text(const ChartData& data) {
    const Json& a = data.about;
    std::string out = fmt::format("{}x{} px", a.at("width").get<int>(), a.at("height").get<int>());
    if (!a.at("f_number").is_null())
        out += fmt::format(", F = {:.4g} mm at f/{:.3g}", a.at("focal_length_mm").get<double>(),
                           a.at("f_number").get<double>());
    if (!a.at("focus_m").is_null())
        out += fmt::format(", focused at {:.4g} m", a.at("focus_m").get<double>());
    if (!a.at("shutter_s").is_null())
        out += fmt::format(", shutter open from {:.4g} to {:.4g} s", a.at("shutter_s")[0].get<double>(),
                           a.at("shutter_s")[1].get<double>());
    out += fmt::format(". Reference: {}", a.at("reference").get<std::string>());
    if (data.noise_rms) out += fmt::format(", good to {:.1f} dB", -20 * std::log10(*data.noise_rms));
    out += fmt::format(
        ". The lens or the shutter affects {:.0f} % of the pixels; the pinhole image has a PSNR of {:.1f} dB",
        100 * data.affected_share, data.pinhole_psnr_db);
    if (data.record_floor)
        out += fmt::format("; the records limit the PSNR to {:.1f} dB", data.record_floor->psnr_db);
    return out + ".";
}

}  // namespace

std::string chart_page(const ChartData& data, const fs::path& folder) {
    Json json = to_json(data);
    std::vector<CostError> costs;
    for (const ChartPoint& p : data.points)
        costs.push_back({p.median_s(), p.figures ? p.figures->whole.rms() : std::nan("")});
    for (Json& p : json["points"]) p["on_frontier"] = false;
    for (const std::size_t i : pareto_frontier(costs)) json["points"][i]["on_frontier"] = true;
    json["what"] = what_text(data);
    json["pictures"] = {{"reference", picture_url(folder / "pictures" / "reference.png", "png")}};
    json["maps"] = Json::object();
    Json finished = Json::array();
    double best = -1;
    json["first"] = "reference";
    for (std::size_t i = 0; i < data.points.size(); ++i) {
        const ChartPoint& p = data.points[i];
        if (!p.figures) continue;
        finished.push_back(json["points"][i]);
        const std::string file = point_file_name(p.name) + ".png";
        json["pictures"][p.name] = picture_url(folder / "pictures" / file, "png");
        json["maps"][p.name] = picture_url(folder / "maps" / file, "png");
        if (!p.is_rays() && p.figures->whole.psnr_db > best) {
            best = p.figures->whole.psnr_db;
            json["first"] = p.name;
        }
    }
    json["points"] = finished;
    std::string charts;
    for (const auto& [name, words] :
         {std::pair{"speed_accuracy", "error against seconds, whole frame"},
          std::pair{"speed_accuracy_affected", "error against seconds, affected pixels"},
          std::pair{"cost", "cost of a picture where one trace serves 1, 10 and 100"}}) {
        const fs::path svg = folder / (std::string(name) + ".svg");
        if (fs::exists(svg))
            charts += fmt::format("<img alt=\"{}\" src=\"{}\">\n", words, picture_url(svg, "svg+xml"));
    }
    const std::string title = "Speed against accuracy: " + data.about.at("scene").get<std::string>();
    std::string out = page_template;
    for (int k = 0; k < 2; ++k) out = replaced(out, "@TITLE@", html_escaped(title));
    out = replaced(out, "@FOOTER@",
                   "Made by <code>postlens chart</code>. Errors are those above the noise of the reference.");
    out = replaced(out, "@CHARTS@", charts);
    return replaced(out, "@DATA@", script_safe(json_dump(json)));
}

}  // namespace postlens
