#include "apps/run_command.h"

#include <chrono>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/json_dump.h"
#include "core/memory.h"

namespace postlens {

CommandResult run_timed(const ParsedCommand& command) {
    const auto start = std::chrono::steady_clock::now();
    CommandResult result = command.run();
    result.json["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

CommandResult run_command(std::vector<std::string> words, const InProcess& in_process) {
    ParsedCommand command = parse_command_line(std::move(words), in_process);
    if (command.dry_run)
        fail(ExitCode::wrong_arguments, "--dry-run: for the program only (expected a command line)");
    if (!command.run) {
        CommandResult help;
        help.text = std::move(command.text);
        help.json["seconds"] = 0.0;
        return help;
    }
    const auto lock = KeptFrame::lock(in_process.kept);
    CommandResult result = run_timed(command);
    if (result.afterwards) {
        std::fputs((result.text + "\n").c_str(), stdout);
        std::fflush(stdout);
        result.afterwards();
    }
    return result;
}

std::string report_json(const CommandResult& result) {
    nlohmann::ordered_json json = result.json;
    json["peak_memory_bytes"] = peak_memory_bytes();
    json["warnings"] = warnings_json(result.warnings);
    return json_dump(json, 2);
}

}  // namespace postlens
