#include "apps/commands/chart_command.h"

#include "chart/chart_page.h"
#include "chart/chart_plots.h"
#include "chart/chart_runner.h"
#include "chart/gnuplot.h"
#include "core/files/output_file.h"

namespace postlens {

CommandResult run_chart_command(const ChartOptions& options) {
    const std::filesystem::path folder = options.output;
    check_chart_request(options.request);
    const bool share = options.request.share.has_value();
    if (options.request.plots && !share) check_gnuplot();
    const ChartRun run = run_chart(options.request, folder, options.restart);
    CommandResult out;
    for (const std::string& note : run.notes) out.warnings.push_back({"scene", note});
    if (!run.missing.empty()) {
        const std::size_t all = run.data.points.size() + run.missing.size();
        out.warnings.push_back({"partial",
                                fmt::format("{} of {} points are missing, e.g. {}", run.missing.size(), all,
                                            run.missing.front()),
                                static_cast<double>(run.missing.size()) / static_cast<double>(all)});
    }
    if (run.data.affected_share < 0.25) {
        out.warnings.push_back(
            {"unaffected",
             fmt::format("lens and shutter change {:.0f} % of the pixels only; figures of the "
                         "whole frame say little (expected a quarter or more)",
                         100 * run.data.affected_share),
             run.data.affected_share});
    }
    const std::string table = chart_markdown(run.data);
    out.json = to_json(run.data);
    out.json["kept"] = run.kept;
    if (share) {
        out.json["page"] = nullptr;
        out.text = table;
        return out;
    }
    if (options.request.plots) {
        draw_with_gnuplot(speed_accuracy_script(run.data, false), folder / "speed_accuracy", 1000, 620);
        draw_with_gnuplot(speed_accuracy_script(run.data, true), folder / "speed_accuracy_affected", 1000,
                          620);
        draw_with_gnuplot(cost_script(run.data), folder / "cost", 1000, 620);
    }
    write_file(folder / "chart.csv", chart_csv(run.data));
    write_file(folder / "chart.md", table);
    write_file(folder / "index.html", chart_page(run.data, folder));
    out.json["page"] = (folder / "index.html").string();
    out.text = table + "\n" + (folder / "index.html").string();
    if (run.kept > 0) out.text += fmt::format(" ({} times were there already)", run.kept);
    return out;
}

}  // namespace postlens
