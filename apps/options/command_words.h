// Finds the files that a command line reads and writes, and the options that change its result. Also lists
// the words of the command line, so that `merge` and --dry-run can run it again.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/options/named_files.h"
#include "apps/share.h"

namespace postlens {

/// These functions mark an option whose value is a file name or contains one, such as `image:FILE`. files_of
/// finds only the files of marked options. If a command writes files, all its options of this kind must
/// therefore be marked. The functions return the option.
CLI::Option* reads(CLI::Option* option);
CLI::Option* reads_of_impulse(CLI::Option* option);
CLI::Option* reads_of_curve(CLI::Option* option);
CLI::Option* reads_of_object(CLI::Option* option);
CLI::Option* writes(CLI::Option* option);
/// Returns the innermost subcommand that was parsed, such as `lens psf`. Returns `app` itself if there is
/// none.
[[nodiscard]] CLI::App& parsed_subcommand(CLI::App& app);
/// Returns the files that are named by the marked options of the parsed subcommand.
[[nodiscard]] std::vector<NamedFile> files_of(CLI::App& app);
/// Throws Error(wrong_arguments) if an option of the parsed subcommand has an empty value. The cause may be a
/// shell variable that is not set. An output with an empty name would otherwise be computed but not written.
void refuse_empty_values(CLI::App& app);
/// Returns the options of the parsed subcommand and the files that it reads.
[[nodiscard]] AskedFor asked_for(CLI::App& root);

/// Returns the words of the command line, without --share, --dry-run, --json and the options that name
/// outputs.
[[nodiscard]] std::vector<std::string> words_of(CLI::App& app);

}  // namespace postlens
