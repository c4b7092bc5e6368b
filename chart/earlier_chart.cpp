#include "chart/earlier_chart.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "chart/machine.h"
#include "core/error.h"
#include "core/files/share_table.h"
#include "core/files/text_file.h"
#include "scene/file_digest.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t largest_chart_bytes = 64U << 20U;

}  // namespace

std::string chart_key(const ChartRequest& r, const ChartView& v, const Scene& scene) {
    std::string reference = fmt::format("{} spp", r.reference_spp);
    if (r.reference) {
        const auto contents = [](const fs::path& path) { return sha256_of_file(path).substr(0, 16); };
        reference = contents(*r.reference);
        if (r.second_reference) reference += " " + contents(*r.second_reference);
    }
    std::string shutter = v.shutter ? fmt::format("{}:{}", v.shutter->open_s, v.shutter->close_s) : "none";
    if (scene.lumens_per_watt) reference += fmt::format(" lumens {}", *scene.lumens_per_watt);
    if (scene.exposure_stops != 0) reference += fmt::format(" exposure {}", scene.exposure_stops);
    return fmt::format("{} x{} '{}' {}x{} d={} F={} f/{} s={} shutter {} reference {}",
                       scene.sha256.substr(0, 16), scene.metres_per_unit, r.camera_name, v.width, v.height,
                       v.film_distance_mm, v.lens.focal_length_mm, v.lens.f_number, v.focus_m, shutter,
                       reference);
}

std::vector<fs::path> earlier_charts(const ChartRequest& request, const fs::path& folder,
                                     const fs::path& chart) {
    std::vector<fs::path> out;
    if (!request.share) out = share_tables(folder, "chart");
    if (fs::exists(chart)) out.push_back(chart);
    return out;
}

bool take_over_chart(const fs::path& path, const std::string& key, bool own, ChartData& data) {
    ChartData from = chart_from_json(read_text_file(path, largest_chart_bytes), path);
    if (from.key != key) {
        if (!own) return false;
        fail(ExitCode::wrong_arguments,
             "{}: holds another chart (got {}; expected {}); --restart begins anew",
             path.parent_path().string(), from.key, key);
    }
    const bool other_machine =
        (from.about.is_object() ? from.about.value("machine", Json()) : Json()) != machine_json();
    const auto add = [](auto& to, auto& of, const auto& same) {
        for (auto& m : of) {
            const auto at =
                std::find_if(to.begin(), to.end(), [&](const auto& known) { return same(known, m); });
            if (at == to.end()) {
                to.push_back(std::move(m));
            } else if (m.seconds.size() > at->seconds.size()) {
                *at = std::move(m);
            }
        }
    };
    add(from.traces, data.traces, [](const ChartTrace& a, const ChartTrace& b) { return a.name == b.name; });
    add(from.points, data.points,
        [](const ChartPoint& a, const ChartPoint& b) { return a.name == b.name && a.trace == b.trace; });
    data = std::move(from);
    return other_machine;
}

void arrange_by_plan(const ChartPlan& plan, ChartData& data) {
    std::vector<ChartTrace> traces;
    for (const PlannedTrace& t : plan.traces) {
        ChartTrace fresh{.name = t.name};
        for (const ChartTrace& old : data.traces) {
            if (old.name == t.name) fresh = old;
        }
        traces.push_back(std::move(fresh));
    }
    data.traces = std::move(traces);
    std::vector<ChartPoint> points;
    for (const PlannedPoint& p : plan.points) {
        ChartPoint fresh{.curve = p.curve, .name = p.name, .amount = p.amount, .trace = p.trace};
        for (const ChartPoint& old : data.points) {
            if (old.name == p.name && old.trace == p.trace) fresh = old;
        }
        points.push_back(std::move(fresh));
    }
    data.points = std::move(points);
}

}  // namespace postlens
