#include "chart/gnuplot.h"

#include <fmt/format.h>
#include <fstream>

#include "core/child_process.h"
#include "core/error.h"
#include "core/files/output_file.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

std::string with_every(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

// Quotes a path for gnuplot. Single quotes are escaped by doubling.
std::string quoted(const fs::path& path) {
    return fmt::format("'{}'", with_every(path.string(), "'", "''"));
}

}  // namespace

void check_gnuplot() {
    if (run_child({"gnuplot", "--version"}).exit_code != 0) {
        fail(ExitCode::invalid_input,
             "gnuplot: cannot be run (got no such program; expected Debian's gnuplot-nox, or --no-plots)");
    }
}

void draw_with_gnuplot(const std::string& script, const fs::path& base, int width_px, int height_px) {
    const auto with = [&](const char* ending) { return fs::path(base.string() + ending); };
    const struct {
        const char* ending;
        std::string terminal;
    } kinds[] = {{".svg", fmt::format("svg size {},{} font 'sans-serif,13' background rgb 'white' noenhanced",
                                      width_px, height_px)},
                 {".png", fmt::format("pngcairo size {},{} font 'sans,11' noenhanced", width_px, height_px)}};
    for (const auto& kind : kinds) {
        OutputFile out(with(kind.ending)), log(with(".log"));
        OutputFile source(with(".gp"));
        const std::string text = with_every(with_every(script, "@TERMINAL@", kind.terminal), "@OUTPUT@",
                                            quoted(out.temporary_path()));
        source.write(text);
        const int status =
            run_child({"gnuplot", source.temporary_path().string()}, log.temporary_path()).exit_code;
        if (status != 0) {
            std::ifstream said(log.temporary_path());
            std::string line;
            while (line.empty() && std::getline(said, line)) {
            }
            fail(ExitCode::cannot_write, "{}: gnuplot failed (got exit status {}, '{}'; expected 0)",
                 out.target().string(), status, line);
        }
        out.commit();
    }
    write_file(with(".gp"), with_every(with_every(script, "@TERMINAL@", kinds[0].terminal), "@OUTPUT@",
                                       quoted(with(".svg").filename())));
}

}  // namespace postlens
