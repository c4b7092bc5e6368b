#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <string>
#include <unistd.h>
#include <vector>

#include "apps/cli.h"
#include "apps/run_command.h"
#include "core/caught_error.h"
#include "core/job.h"
#include "core/progress.h"
#include "core/signals.h"
#include "core/text.h"

namespace {

using postlens::CommandResult;
using postlens::ExitCode;
using postlens::ParsedCommand;

/// Writes `text` to the stream `where`, and ends the line. Errors of writing are not detected here, but by
/// check_output at the end of the program.
void say(std::FILE* where, const std::string& text) {
    if (text.empty()) return;
    std::fputs(text.c_str(), where);
    if (text.back() != '\n') std::fputc('\n', where);
}

/// Reports an error if standard output could not be written, for example because the disk is full.
void check_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        postlens::fail(ExitCode::cannot_write, "standard output: cannot write");
}

/// Opens /dev/null in place of each closed standard stream. Otherwise, the next opened file would get its
/// descriptor, and messages would go into that file.
void take_closed_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) == -1) ::open("/dev/null", O_RDONLY);
    }
}

void report(const CommandResult& result, const ParsedCommand& command) {
    if (command.json) {
        say(stdout, postlens::report_json(result));
    } else if (!command.quiet || result.afterwards) {
        say(stdout, postlens::printable_lines(result.text));
    }
    // With --json, the JSON contains the warnings, and only errors are printed to standard error.
    if (!command.json && !command.quiet) {
        for (const auto& w : result.warnings)
            say(stderr, "postlens: warning: " + postlens::printable(w.text));
    }
}

void say_error(const std::string& text) {
    say(stderr, "postlens: " + postlens::printable(text));
}

int run(int argc, char** argv, postlens::Job& process, int& requeue_code) {
    const postlens::JobScope scope_of_process(process);
    const ParsedCommand command = postlens::parse_command_line({argv + 1, argv + argc});
    requeue_code = command.requeue_code;
    if (!command.run) {
        say(stdout, command.text);
        check_output();
        return 0;
    }
    postlens::Job job(
        {.threads = command.threads, .watch = command.quiet ? nullptr : postlens::terminal_bar()});
    const postlens::JobScope scope(job);
    const CommandResult result = postlens::run_timed(command);
    report(result, command);
    check_output();
    if (result.afterwards) result.afterwards();
    return static_cast<int>(result.exit_code);
}

}  // namespace

int main(int argc, char** argv) {
    take_closed_streams();
    // A signal such as SIGINT cancels this job, and with it the command. The job is static, because a signal
    // may arrive after main() has returned.
    static postlens::Job process({.threads = 1});
    postlens::cancel_on_signals(process);
    // SIGXFSZ and SIGPIPE are sent to the program when it writes to a file that becomes too large or to a
    // closed pipe. By default, they end the program without a message. Here, they are ignored, so that the
    // write returns an error instead, which is printed.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    int requeue_code = static_cast<int>(ExitCode::interrupted);
    try {
        return run(argc, argv, process, requeue_code);
    } catch (...) {
        const postlens::Error e = postlens::caught_error();
        say_error(e.what());
        if (e.code() == ExitCode::interrupted && postlens::is_asked_to_requeue()) return requeue_code;
        return static_cast<int>(e.code());
    }
}
