// Finds the files that a command line reads and writes, and the options that determine its result. Also
// repeats the command line for `merge` and --dry-run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/options/named_files.h"
#include "apps/share.h"

namespace postlens {

/// Mark an option whose text is a file name or contains one (`image:FILE`, `box|triangle|FILE`, an object or
/// its mask), so that files_of finds the file. A command that writes files must mark all such options. Both
/// functions return the option.
CLI::Option* reads(CLI::Option* option);
CLI::Option* reads_of_impulse(CLI::Option* option);
CLI::Option* reads_of_curve(CLI::Option* option);
CLI::Option* reads_of_object(CLI::Option* option);
CLI::Option* writes(CLI::Option* option);
/// Returns the innermost subcommand that was parsed, such as `lens psf`; `app` itself if there is none.
[[nodiscard]] CLI::App& parsed_subcommand(CLI::App& app);
/// Returns the files that the marked options of the parsed subcommand name.
[[nodiscard]] std::vector<NamedFile> files_of(CLI::App& app);
/// Throws Error(wrong_arguments) if an option of the parsed subcommand has an empty value, for example
/// because a shell variable is not set. No option accepts an empty value. An output with an empty name would
/// be computed but not written.
void refuse_empty_values(CLI::App& app);
/// Returns the options of the parsed subcommand and the files that it reads.
[[nodiscard]] AskedFor asked_for(CLI::App& root);

/// Returns the words of the command line without --share, --dry-run, --json and the options that name
/// outputs.
[[nodiscard]] std::vector<std::string> words_of(CLI::App& app);

}  // namespace postlens
