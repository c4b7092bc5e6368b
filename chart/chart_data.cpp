#include "chart/chart_data.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

#include "chart/pareto.h"
#include "core/error.h"

namespace postlens {

nlohmann::ordered_json exact_number(double value) {
    if (std::isnan(value)) return nullptr;
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    return value;
}

double number_from(const nlohmann::ordered_json& json) {
    if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (json.is_string())
        return json.get<std::string>() == "inf" ? std::numeric_limits<double>::infinity()
                                                : -std::numeric_limits<double>::infinity();
    return json.get<double>();
}

nlohmann::ordered_json to_json(const ChartError& e) {
    return {{"psnr_db", exact_number(e.psnr_db)},
            {"is_bound", e.is_bound},
            {"range_db", {exact_number(e.least_psnr_db), exact_number(e.greatest_psnr_db)}}};
}

ChartError error_from(const nlohmann::ordered_json& json) {
    return {.psnr_db = number_from(json.at("psnr_db")),
            .is_bound = json.at("is_bound").get<bool>(),
            .least_psnr_db = number_from(json.at("range_db").at(0)),
            .greatest_psnr_db = number_from(json.at("range_db").at(1))};
}

namespace {

using Json = nlohmann::ordered_json;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

Json to_json(const ChartFigures& f) {
    return {{"whole", to_json(f.whole)},
            {"affected", to_json(f.affected)},
            {"relmse", exact_number(f.relmse)},
            {"ssim", exact_number(f.ssim)},
            {"flip", exact_number(f.flip)}};
}

ChartFigures figures_from(const Json& json) {
    return {.whole = error_from(json.at("whole")),
            .affected = error_from(json.at("affected")),
            .relmse = number_from(json.at("relmse")),
            .ssim = number_from(json.at("ssim")),
            .flip = number_from(json.at("flip"))};
}

std::string db_text(const ChartError& e) {
    if (std::isnan(e.psnr_db)) return "-";
    if (std::isinf(e.psnr_db)) return "no error";
    return fmt::format("{}{:.1f}", e.is_bound ? ">= " : "", e.psnr_db);
}

std::string csv_number(double value) {
    return std::isnan(value) ? "" : fmt::format("{:.6g}", value);
}

// Quotes a CSV field, because names may contain commas and quotes.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

std::string spread_text(const std::vector<double>& seconds) {
    if (seconds.empty()) return "-";
    const auto [low, high] = std::minmax_element(seconds.begin(), seconds.end());
    if (seconds.size() == 1) return fmt::format("{:.3g}", seconds[0]);
    return fmt::format("{:.3g} ({:.3g} to {:.3g})", median(seconds), *low, *high);
}

}  // namespace

double median(std::vector<double> values) {
    if (values.empty()) return unknown;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

double ChartError::rms() const {
    return std::pow(10.0, -psnr_db / 20);
}

double ChartTrace::median_s() const {
    return median(seconds);
}
double ChartPoint::median_s() const {
    return median(seconds);
}

double ChartPoint::seconds_each(const ChartTrace* from, double pictures) const {
    double each = median_s();
    if (!further_s.empty()) {
        const double further = median(further_s);
        const double in_sweep = further + (median(first_of_many_s) - further) / std::max(pictures, 1.0);
        each = std::min(each, in_sweep);
    }
    return each + (from != nullptr ? from->median_s() / pictures : 0);
}

const ChartTrace* ChartData::trace_of(const ChartPoint& point) const {
    for (const ChartTrace& t : traces) {
        if (t.name == point.trace) return &t;
    }
    return nullptr;
}

ChartError chart_error(const PixelErrors& plain, const std::optional<NoiseFloor>& noise) {
    if (!noise || std::isnan(noise->encoded.mse)) return {plain.psnr_db, false, plain.psnr_db, plain.psnr_db};
    const NoisyError& e = noise->encoded;
    const double least = psnr_from_mse(e.greatest_rms() * e.greatest_rms());
    const double greatest = psnr_from_mse(e.least_rms() * e.least_rms());
    return {e.is_bound() ? least : psnr_from_mse(e.mse), e.is_bound(), least, greatest};
}

ChartFigures chart_figures(const Comparison& c) {
    ChartFigures out;
    out.whole = chart_error(c.whole.errors, c.noise);
    const Figures none{.errors = {.psnr_db = unknown}};
    out.affected = chart_error(c.affected ? c.affected->errors : none.errors, c.affected_noise);
    out.relmse = c.noise && !c.noise->relative.is_bound() ? c.noise->relative.mse : c.whole.errors.relmse;
    out.ssim = c.whole.ssim;
    out.flip = c.flip(c.whole);
    return out;
}

Json to_json(const ChartData& data) {
    Json out{{"chart", 1},
             {"key", data.key},
             {"about", data.about},
             {"affected_share", data.affected_share},
             {"noise_rms", data.noise_rms ? exact_number(*data.noise_rms) : Json(nullptr)},
             {"record_floor", data.record_floor ? to_json(*data.record_floor) : Json(nullptr)},
             {"pinhole_psnr_db", exact_number(data.pinhole_psnr_db)},
             {"reference_s", exact_number(data.reference_s)},
             {"traces", Json::array()},
             {"points", Json::array()}};
    for (const ChartTrace& t : data.traces) {
        out["traces"].push_back(
            {{"name", t.name}, {"seconds", t.seconds}, {"records", t.records}, {"bytes", t.bytes}});
    }
    for (const ChartPoint& p : data.points) {
        out["points"].push_back({{"curve", p.curve},
                                 {"name", p.name},
                                 {"amount", p.amount},
                                 {"trace", p.trace},
                                 {"seconds", p.seconds},
                                 {"first_of_many_s", p.first_of_many_s},
                                 {"further_s", p.further_s},
                                 {"figures", p.figures ? to_json(*p.figures) : Json(nullptr)},
                                 {"retraced_share", p.retraced_share},
                                 {"warnings", p.warnings}});
    }
    if (!data.part.is_null()) out["part"] = data.part;
    return out;
}

ChartData chart_from_json(const std::string& text, const std::filesystem::path& path) {
    try {
        const Json json = Json::parse(text);
        ChartData out;
        out.key = json.at("key").get<std::string>();
        out.about = json.at("about");
        out.part = json.value("part", Json());
        out.affected_share = json.at("affected_share").get<double>();
        if (!json.at("noise_rms").is_null()) out.noise_rms = number_from(json.at("noise_rms"));
        if (!json.at("record_floor").is_null()) out.record_floor = error_from(json.at("record_floor"));
        out.pinhole_psnr_db = number_from(json.at("pinhole_psnr_db"));
        out.reference_s = number_from(json.at("reference_s"));
        for (const Json& t : json.at("traces")) {
            out.traces.push_back({t.at("name").get<std::string>(), t.at("seconds").get<std::vector<double>>(),
                                  t.at("records").get<std::uint64_t>(), t.at("bytes").get<std::uint64_t>()});
        }
        for (const Json& p : json.at("points")) {
            ChartPoint q;
            q.curve = p.at("curve").get<std::string>();
            q.name = p.at("name").get<std::string>();
            q.amount = p.at("amount").get<int>();
            q.trace = p.at("trace").get<std::string>();
            q.seconds = p.at("seconds").get<std::vector<double>>();
            // Charts of old versions do not contain these two keys.
            q.first_of_many_s = p.value("first_of_many_s", std::vector<double>());
            q.further_s = p.value("further_s", std::vector<double>());
            if (!p.at("figures").is_null()) q.figures = figures_from(p.at("figures"));
            q.retraced_share = p.at("retraced_share").get<double>();
            q.warnings = p.at("warnings").get<std::vector<std::string>>();
            out.points.push_back(std::move(q));
        }
        return out;
    } catch (const nlohmann::json::exception& e) {
        std::string what = e.what();
        std::replace(what.begin(), what.end(), '\n', ' ');
        fail(ExitCode::invalid_input, "{}: not a chart's data ({})", path.string(), what);
    }
}

std::string chart_csv(const ChartData& data) {
    std::string out =
        "point,curve,setting,trace,trace_s,seconds,seconds_least,seconds_greatest,rounds,further_s,psnr_db,"
        "psnr_is_"
        "bound,"
        "affected_psnr_db,affected_is_bound,relmse,ssim,flip,retraced_share,warnings\n";
    for (const ChartPoint& p : data.points) {
        const ChartTrace* t = data.trace_of(p);
        const ChartFigures f = p.figures.value_or(ChartFigures{.whole = {.psnr_db = unknown},
                                                               .affected = {.psnr_db = unknown},
                                                               .relmse = unknown,
                                                               .ssim = unknown,
                                                               .flip = unknown});
        const auto least = std::min_element(p.seconds.begin(), p.seconds.end());
        const auto greatest = std::max_element(p.seconds.begin(), p.seconds.end());
        out += fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(p.name), quoted(p.curve),
            p.amount > 0 ? std::to_string(p.amount) : "", quoted(p.trace),
            t != nullptr ? csv_number(t->median_s()) : "", csv_number(p.median_s()),
            p.seconds.empty() ? "" : csv_number(*least), p.seconds.empty() ? "" : csv_number(*greatest),
            p.seconds.size(), csv_number(median(p.further_s)), csv_number(f.whole.psnr_db),
            f.whole.is_bound ? 1 : 0, csv_number(f.affected.psnr_db), f.affected.is_bound ? 1 : 0,
            csv_number(f.relmse), csv_number(f.ssim), csv_number(f.flip), csv_number(p.retraced_share),
            quoted(fmt::format("{}", fmt::join(p.warnings, " "))));
    }
    return out;
}

std::string chart_markdown(const ChartData& data) {
    std::vector<CostError> rays;
    for (const ChartPoint& p : data.points) {
        if (p.is_rays() && p.figures) rays.push_back({p.median_s(), p.figures->whole.rms()});
    }
    std::string out =
        "| method | s | in a sweep, s | whole frame, dB | affected, dB | relMSE | traced again | rays of "
        "that error, s | "
        "faster with 1 / "
        "10 / 100 pictures a trace |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const ChartPoint& p : data.points) {
        if (!p.figures) continue;
        std::string equal, factors;
        if (!p.is_rays()) {
            const auto s = seconds_for_error(rays, p.figures->whole.rms());
            equal = s ? fmt::format("{:.3g}", *s) : "beyond the rays measured";
            const ChartTrace* t = data.trace_of(p);
            if (s)
                factors = fmt::format("{:.2g} / {:.2g} / {:.2g}", *s / p.seconds_each(t, 1),
                                      *s / p.seconds_each(t, 10), *s / p.seconds_each(t, 100));
        }
        out += fmt::format(
            "| {} | {} | {} | {} | {} | {:.2g} | {} | {} | {} |\n", p.name, spread_text(p.seconds),
            p.further_s.empty() ? "" : fmt::format("{:.3g}", median(p.further_s)), db_text(p.figures->whole),
            db_text(p.figures->affected), p.figures->relmse,
            p.retraced_share > 0 ? fmt::format("{:.1f} %", 100 * p.retraced_share) : "", equal, factors);
    }
    out +=
        fmt::format("\nThe lens or the shutter affects {:.0f} % of the pixels.", 100 * data.affected_share);
    if (data.noise_rms)
        out += fmt::format(
            " The reference image took {:.3g} s. Its own noise corresponds to a PSNR of {:.1f} dB.",
            data.reference_s, -20 * std::log10(*data.noise_rms));
    if (data.record_floor)
        out += fmt::format(
            " The pinhole image made from the sample file has a PSNR of {} dB; its reference is made by "
            "rays.",
            db_text(*data.record_floor));
    out += "\n\n| trace | s | million records | MB |\n|---|---|---|---|\n";
    for (const ChartTrace& t : data.traces) {
        out += fmt::format("| {} | {} | {:.3g} | {:.3g} |\n", t.name, spread_text(t.seconds),
                           static_cast<double>(t.records) / 1e6, static_cast<double>(t.bytes) / 1e6);
    }
    return out;
}

}  // namespace postlens
