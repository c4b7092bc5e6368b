#include "chart/chart_plots.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "chart/pareto.h"

namespace postlens {
namespace {

struct Dot {
    double seconds = 0, rms = 0, low = 0, high = 0;  // low, high: least and greatest seconds
    bool is_bound = false;
};

struct Range {
    double low = 1e300, high = 0;
    void add(double v) {
        if (!(v > 0) || !std::isfinite(v)) return;
        low = std::min(low, v);
        high = std::max(high, v);
    }
};

// Colours by Okabe and Ito, for colour-blind readers. Marks of different shape, for greyscale prints.
struct Style {
    const char* colour;
    int mark, dash;
};

Style style_of(const std::string& curve, const std::map<std::string, int>& variants) {
    static const std::map<std::string, Style> known{
        {"rays", {"#000000", 13, 1}},    {"pinhole", {"#999999", 2, 1}},    {"scatter", {"#e69f00", 5, 1}},
        {"layers", {"#009e73", 9, 1}},   {"lightfield", {"#0072b2", 7, 1}}, {"hybrid", {"#d55e00", 11, 1}},
        {"convolve", {"#e69f00", 5, 1}}, {"auto", {"#cc79a7", 15, 1}}};
    const std::string base = curve.substr(0, curve.find(','));
    const auto it = known.find(base);
    Style out = it == known.end() ? Style{"#56b4e9", 3, 1} : it->second;
    // Curves of one method share a colour. Curves from sample files with fewer records are dashed, with
    // hollow markers.
    if (const int v = variants.at(curve); v > 0) {
        out.dash = 1 + v;
        out.mark -= 1;
    }
    return out;
}

std::vector<std::string> curves_of(const ChartData& data) {
    std::vector<std::string> out;
    for (const ChartPoint& p : data.points) {
        if (p.figures && std::find(out.begin(), out.end(), p.curve) == out.end()) out.push_back(p.curve);
    }
    return out;
}

const ChartError& error_of(const ChartPoint& p, bool affected) {
    return affected ? p.figures->affected : p.figures->whole;
}

bool is_drawn(const ChartPoint& p, bool affected) {
    return p.figures && std::isfinite(error_of(p, affected).psnr_db) && p.median_s() > 0;
}

// Returns gnuplot's tick marks for an axis of RMS errors, labelled with the PSNR in dB.
std::string decibel_tics(const Range& y) {
    std::string out;
    for (int db = 0; db <= 120; db += 5) {
        const double v = std::pow(10.0, -db / 20.0);
        if (v < y.low / 2 || v > y.high * 2) continue;
        out += fmt::format("{}'{} dB' {:.6g}", out.empty() ? "" : ", ", db, v);
    }
    return out;
}

std::string preamble(const Range& x, const Range& y, const std::string& title, const char* x_label,
                     const char* y_label) {
    return fmt::format(
        "set terminal @TERMINAL@\nset output @OUTPUT@\nset logscale xy\nset title \"{}\"\n"
        "set xlabel '{}'\nset ylabel '{}'\nset xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n"
        "set ytics ({})\nset format x '%g'\nset grid xtics ytics linecolor rgb '#dddddd'\n"
        "set key outside right top vertical Left reverse spacing 1.1 samplen 3\n",
        title, x_label, y_label, x.low / 1.5, x.high * 1.5, y.low / 1.3, y.high * 1.3, decibel_tics(y));
}

std::string title_of(const ChartData& data) {
    const auto& a = data.about;
    std::string out = a.at("scene").get<std::string>();
    std::replace(out.begin(), out.end(), '"', '\'');
    out += fmt::format(", {}x{}", a.at("width").get<int>(), a.at("height").get<int>());
    if (!a.at("f_number").is_null())
        out += fmt::format(", {:.4g} mm f/{:.3g}", a.at("focal_length_mm").get<double>(),
                           a.at("f_number").get<double>());
    if (!a.at("focus_m").is_null()) out += fmt::format(", focus {:.4g} m", a.at("focus_m").get<double>());
    if (!a.at("shutter_s").is_null())
        out += fmt::format(", shutter {:.4g} to {:.4g} s", a.at("shutter_s")[0].get<double>(),
                           a.at("shutter_s")[1].get<double>());
    return out;
}

std::string block(const std::string& name, const std::vector<Dot>& dots) {
    std::string out = name + " << EOD\n";
    for (const Dot& d : dots)
        out += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {}\n", d.seconds, d.rms, d.low, d.high,
                           d.is_bound ? 1 : 0);
    return out + "EOD\n";
}

}  // namespace

std::string speed_accuracy_script(const ChartData& data, bool affected) {
    const std::vector<std::string> curves = curves_of(data);
    std::map<std::string, int> variants, count;
    for (auto it = curves.rbegin(); it != curves.rend(); ++it) {
        const bool best = it->find(',') == std::string::npos;
        variants[*it] = best ? 0 : ++count[it->substr(0, it->find(','))];
    }
    Range x, y;
    std::string blocks, plots;
    std::vector<CostError> all;
    std::vector<Dot> bounds;
    int number = 0;
    for (const std::string& curve : curves) {
        std::vector<Dot> dots;
        for (const ChartPoint& p : data.points) {
            if (p.curve != curve || !is_drawn(p, affected)) continue;
            const auto [low, high] = std::minmax_element(p.seconds.begin(), p.seconds.end());
            const ChartError& e = error_of(p, affected);
            dots.push_back({p.median_s(), e.rms(), *low, *high, e.is_bound});
            if (e.is_bound) bounds.push_back(dots.back());
            all.push_back({p.median_s(), e.rms()});
            x.add(p.median_s());
            y.add(e.rms());
        }
        if (dots.empty()) continue;
        const Style s = style_of(curve, variants);
        const std::string name = fmt::format("$d{}", number++);
        blocks += block(name, dots);
        plots += fmt::format(
            "{0} using 1:2:3:4 with xerrorbars linecolor rgb '{1}' linewidth 1 pointtype -1 notitle, "
            "{0} using 1:2 with linespoints linecolor rgb '{1}' linewidth {2} dashtype {3} pointtype {4} "
            "pointsize 1.2 "
            "title '{5}', ",
            name, s.colour, s.dash == 1 ? "2" : "1.2", s.dash, s.mark, curve);
    }
    std::vector<Dot> frontier;
    for (const std::size_t i : pareto_frontier(all))
        frontier.push_back({all[i].seconds, all[i].error, 0, 0, false});
    blocks += block("$frontier", frontier) + block("$bounds", bounds);
    plots += "$frontier using 1:2 with lines linecolor rgb '#88cc0044' linewidth 7 title 'frontier', ";
    if (!bounds.empty()) {
        plots +=
            "$bounds using 1:2:(0):(-$2*0.2) with vectors linecolor rgb 'black' filled title 'at most this "
            "error', ";
    }
    if (data.noise_rms && !affected) {
        y.add(*data.noise_rms);
        plots += fmt::format(
            "{:.6g} with lines linecolor rgb '#777777' dashtype 3 title 'noise of the reference', ",
            *data.noise_rms);
    }
    if (data.record_floor && std::isfinite(data.record_floor->psnr_db) && !affected) {
        y.add(data.record_floor->rms());
        plots +=
            fmt::format("{:.6g} with lines linecolor rgb '#777777' dashtype 4 title 'floor of the records', ",
                        data.record_floor->rms());
    }
    plots.resize(plots.size() - 2);
    return preamble(x, y, title_of(data), "seconds a picture, without the trace",
                    affected ? "error of the affected pixels above the noise, PSNR"
                             : "error of the whole frame above the noise, PSNR") +
           blocks + "plot " + plots + "\n";
}

std::string cost_script(const ChartData& data) {
    Range x, y;
    std::string blocks, plots;
    std::vector<Dot> rays;
    for (const ChartPoint& p : data.points) {
        if (!p.is_rays() || !is_drawn(p, false)) continue;
        rays.push_back({p.median_s(), p.figures->whole.rms(), 0, 0, false});
        x.add(rays.back().seconds);
        y.add(rays.back().rms);
    }
    blocks += block("$rays", rays);
    plots += "$rays using 1:2 with linespoints linecolor rgb 'black' linewidth 2 pointtype 13 title 'rays', ";
    const char* colours[] = {"#d55e00", "#e69f00", "#0072b2"};
    int number = 0;
    for (const int pictures : {1, 10, 100}) {
        std::vector<CostError> costs;
        for (const ChartPoint& p : data.points) {
            if (!p.is_rays() && is_drawn(p, false))
                costs.push_back({p.seconds_each(data.trace_of(p), pictures), p.figures->whole.rms()});
        }
        std::vector<Dot> frontier;
        for (const std::size_t i : pareto_frontier(costs)) {
            frontier.push_back({costs[i].seconds, costs[i].error, 0, 0, false});
            x.add(costs[i].seconds);
            y.add(costs[i].error);
        }
        blocks += block(fmt::format("$n{}", number), frontier);
        plots += fmt::format(
            "$n{0} using 1:2 with linespoints linecolor rgb '{1}' linewidth 2 pointtype 7 title "
            "'post-process, {2} picture{3} "
            "a trace', ",
            number, colours[number], pictures, pictures == 1 ? "" : "s");
        ++number;
    }
    plots.resize(plots.size() - 2);
    return preamble(x, y, title_of(data), "seconds a picture, with its share of the trace",
                    "error of the whole frame above the noise, PSNR") +
           blocks + "plot " + plots + "\n";
}

}  // namespace postlens
