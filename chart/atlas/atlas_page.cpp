#include "chart/atlas/atlas_page.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "chart/html_text.h"

namespace postlens {
namespace {

std::string decibels(const ChartError& e) {
    return fmt::format("{}{:.1f}", e.is_bound ? "≥ " : "", e.psnr_db);
}

std::string codes(const std::vector<std::string>& warnings, const char* quote) {
    if (warnings.empty()) return "none";
    return fmt::format("{0}{1}{0}", quote, fmt::join(warnings, fmt::format("{0}, {0}", quote)));
}

/// Returns a method's name and the settings that the case changes.
std::string label(const AtlasMethod& m) {
    std::string out = m.name;
    if (m.views) out += fmt::format(", {} views", *m.views);
    if (m.depths) out += fmt::format(", {} depths", *m.depths);
    if (m.spacing == DepthSpacing::linear) out += " evenly in z'";
    if (m.name == "rays") out += fmt::format(", {} a pixel", m.spp);
    if (m.depth_model == DepthModel::path) out += ", by the path's length";
    if (m.depth_model == DepthModel::first_hit) out += ", by the first hit";
    const AtlasTrace& t = m.trace;
    if (!t.for_view) out += ", of a plain trace";
    if (t.for_f_number) out += fmt::format(", traced for f/{:.4g}", *t.for_f_number);
    if (t.for_focus_m) out += fmt::format(", traced for a focus at {:.4g} m", *t.for_focus_m);
    if (t.levels) out += fmt::format(", subdivided {} times", *t.levels);
    if (t.hidden_layers) out += fmt::format(", {} hidden layers", *t.hidden_layers);
    if (t.overscan_px) out += fmt::format(", {} px of overscan", *t.overscan_px);
    if (t.keys) out += fmt::format(", {} key{}", *t.keys, *t.keys == 1 ? "" : "s");
    if (t.max_depth) out += fmt::format(", trees of depth {}", *t.max_depth);
    return out;
}

std::string view_text(const ChartRequest& v) {
    std::string out =
        fmt::format("`{}`, {}x{} px", v.scene.filename().string(), *v.camera.width, *v.camera.height);
    if (v.focal_length_mm) out += fmt::format(", {:.4g} mm", *v.focal_length_mm);
    if (v.f_number && std::isfinite(*v.f_number)) out += fmt::format(", f/{:.4g}", *v.f_number);
    if (v.focus_m)
        out +=
            std::isfinite(*v.focus_m) ? fmt::format(", focus {:.4g} m", *v.focus_m) : ", focus at infinity";
    if (v.shutter && v.shutter->open_s == v.shutter->close_s) {
        out += fmt::format(", shutter opened and closed at {:.4g} s", v.shutter->open_s);
    } else if (v.shutter) {
        out += fmt::format(", shutter {:.4g} to {:.4g} s", v.shutter->open_s, v.shutter->close_s);
    }
    return out;
}

struct Row {
    std::string method, whole, affected, energy, warnings, retraced;
};

Row row(const AtlasMethod& m, const AtlasFigures& f, const char* quote) {
    return {label(m),
            decibels(f.error),
            decibels(f.affected),
            fmt::format("{:+.1f} %", 100 * (f.energy - 1)),
            codes(f.warnings, quote),
            f.retraced_share > 0 ? fmt::format("{:.1f} %", 100 * f.retraced_share) : "none"};
}

std::vector<Row> rows(const AtlasEntry& e, const char* quote) {
    std::vector<Row> out{row(e.what.method, e.result.method, quote)};
    if (e.what.remedy && e.result.remedy) {
        out.push_back(row(*e.what.remedy, *e.result.remedy, quote));
        out.back().method = "remedy: " + out.back().method;
    }
    out.push_back({"pinhole", fmt::format("{:.1f}", e.result.pinhole_db), "", "", "", ""});
    out.push_back({"noise of the rays", fmt::format("{:.1f}", e.result.noise_db), "", "", "", ""});
    return out;
}

/// Returns the caption of a test case in the document. It states the scene and the camera, the percentage of
/// pixels that differ from the pinhole image (that is, which the blur changes), and the percentage of the
/// method's squared error that is due to the expected cause.
std::string caption(const AtlasEntry& e) {
    const double affected = 100 * e.result.affected_share;
    std::string out =
        fmt::format("Scene {}. {} % of the pixels differ from the pinhole image", view_text(e.what.view),
                    affected < 0.5 ? "Fewer than 0.5" : fmt::format("{:.0f}", affected));
    if (e.result.named_share) {
        const auto& causes = atlas_causes();
        const auto cause = std::find_if(causes.begin(), causes.end(),
                                        [&](const AtlasCause& c) { return c.word == e.what.cause; });
        out += fmt::format("; {:.0f} % of the squared error comes from {}", 100 * *e.result.named_share,
                           cause->source);
    }
    return out + ".";
}

constexpr const char* heading = "# An atlas of failure\n\n";

/// Converts Markdown to HTML: paragraphs, bullet lists and headings only.
std::string html_of(const std::string& markdown) {
    std::string out, paragraph;
    const auto flush = [&] {
        if (!paragraph.empty()) out += fmt::format("<p>{}</p>\n", html_escaped(paragraph));
        paragraph.clear();
    };
    std::size_t begin = 0;
    while (begin < markdown.size()) {
        const std::size_t end = std::min(markdown.find('\n', begin), markdown.size());
        const std::string line = markdown.substr(begin, end - begin);
        begin = end + 1;
        if (line.empty() || line.starts_with("- ") || line.starts_with("#")) flush();
        if (line.starts_with("## ")) {
            out += fmt::format("<h2>{}</h2>\n", html_escaped(line.substr(3)));
        } else if (!line.empty()) {
            if (!paragraph.empty()) paragraph += ' ';
            paragraph += line;
        }
    }
    flush();
    return out;
}

}  // namespace

std::string atlas_markdown(const AtlasRun& run) {
    std::string out = heading + run.introduction;
    if (!run.introduction.empty()) out += "\n";
    out +=
        "| case | cause | set | method | dB | remedy | dB | warnings |\n| --- | --- | --- | --- | --- | --- "
        "| --- | --- |\n";
    const auto for_each = [&](const std::string& cause, const auto& work) {
        for (const AtlasEntry& e : run.entries) {
            if (e.what.cause == cause) work(e);
        }
    };
    for (const AtlasCause& cause : atlas_causes()) {
        for_each(cause.word, [&](const AtlasEntry& e) {
            const AtlasCase& c = e.what;
            out += fmt::format("| [{}](#{}) | {} | {} | {} | {} | {} | {} | {} |\n", c.title, c.name, c.cause,
                               c.set, c.method.name, decibels(e.result.method.error),
                               c.remedy ? c.remedy->name : "",
                               e.result.remedy ? decibels(e.result.remedy->error) : "",
                               codes(e.result.method.warnings, "`"));
        });
    }
    for (const AtlasCause& cause : atlas_causes()) {
        std::string text;
        for_each(cause.word, [&](const AtlasEntry& e) {
            const AtlasCase& c = e.what;
            text += fmt::format("### <a id=\"{}\"></a>{}\n\n![{}]({})\n\n", c.name, c.title, c.title,
                                atlas_strip(c.name).generic_string());
            text += fmt::format("*{}*\n\n{}\n\n- Detected: {}\n- What happens: {}\n\n", caption(e), c.why,
                                c.detection, c.outcome);
            text +=
                "| method | dB | affected, dB | energy | traced again | warnings |\n| --- | --- | --- | --- "
                "| --- | --- |\n";
            for (const Row& r : rows(e, "`"))
                text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", r.method, r.whole, r.affected,
                                    r.energy, r.retraced, r.warnings);
            text += "\n";
        });
        if (!text.empty()) out += fmt::format("\n## {}\n\n{}\n\n{}", cause.word, cause.meaning, text);
    }
    while (out.ends_with("\n\n")) out.pop_back();
    return out;
}

std::string atlas_html(const AtlasRun& run, const std::filesystem::path& folder) {
    std::string out =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>An atlas of "
        "failure</title>\n"
        "<style>body{font:16px/1.45 sans-serif;max-width:820px;margin:2em auto;padding:0 1em;color:#222}"
        "img{max-width:100%;image-rendering:pixelated}table{border-collapse:collapse;font-size:14px}"
        "td,th{border:1px solid #bbb;padding:2px 8px;text-align:left}.view{color:#666;font-size:14px}</style>"
        "</head><body>\n<h1>An atlas of failure</h1>\n" +
        html_of(run.introduction);
    for (const AtlasCause& cause : atlas_causes()) {
        bool is_first = true;
        for (const AtlasEntry& e : run.entries) {
            const AtlasCase& c = e.what;
            if (c.cause != cause.word) continue;
            if (is_first)
                out += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", html_escaped(cause.word),
                                   html_escaped(cause.meaning));
            is_first = false;
            out += fmt::format("<h3 id=\"{}\">{}</h3>\n<img alt=\"{}\" src=\"{}\">\n", html_escaped(c.name),
                               html_escaped(c.title), html_escaped(c.title),
                               picture_url(folder / atlas_strip(c.name), "png"));
            out += fmt::format(
                "<p class=\"view\">{}</p>\n<p>{}</p>\n<p><b>Detected:</b> {}</p>\n<p><b>What "
                "happens:</b> {}</p>\n",
                html_escaped(caption(e)), html_escaped(c.why), html_escaped(c.detection),
                html_escaped(c.outcome));
            out += "<table><tr><th>method<th>dB<th>affected, dB<th>energy<th>traced again<th>warnings</tr>\n";
            for (const Row& r : rows(e, ""))
                out += fmt::format("<tr><td>{}<td>{}<td>{}<td>{}<td>{}<td>{}</tr>\n", html_escaped(r.method),
                                   r.whole, r.affected, r.energy, r.retraced, html_escaped(r.warnings));
            out += "</table>\n";
        }
    }
    return out + "</body></html>\n";
}

}  // namespace postlens
