#include "chart/gnuplot.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "core/output_file.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

// Runs a program, writes its output to `log` and returns its exit status, or -1 if it could not be started.
int run(const std::vector<std::string>& arguments, const fs::path& log) {
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t pid = 0;
    const int error = posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) return -1;
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
    return text;
}

// Quotes a path for gnuplot, which needs only the quote itself doubled within single quotes.
std::string quoted(const fs::path& path) {
    return fmt::format("'{}'", replaced(path.string(), "'", "''"));
}

}  // namespace

void check_gnuplot() {
    if (run({"gnuplot", "--version"}, "/dev/null") != 0) {
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
        const std::string text =
            replaced(replaced(script, "@TERMINAL@", kind.terminal), "@OUTPUT@", quoted(out.temporary_path()));
        source.write(text);
        const int status = run({"gnuplot", source.temporary_path().string()}, log.temporary_path());
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
    write_file(with(".gp"), replaced(replaced(script, "@TERMINAL@", kinds[0].terminal), "@OUTPUT@",
                                     quoted(with(".svg").filename())));
}

}  // namespace postlens
