// Finds the files that a command line reads and writes, and the options on which its result depends. By
// these, a later run recognises whether an existing result was made by the same command. Also returns the
// words of the command line, with which `merge` and --dry-run can run the command again.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/options/named_files.h"
#include "apps/share.h"

namespace postlens {

/// These functions mark an option whose value refers to a file, so that `files_of` finds this file. They
/// return the option. With `reads` and `writes`, the value is the file name. With the others, the value may
/// be a file name, contain one (such as `image:FILE`), or contain none.
CLI::Option* reads(CLI::Option* option);
CLI::Option* reads_of_impulse(CLI::Option* option);
CLI::Option* reads_of_curve(CLI::Option* option);
CLI::Option* reads_of_object(CLI::Option* option);
CLI::Option* writes(CLI::Option* option);
/// Returns the innermost subcommand, for example `psf` for `lens psf`, or `app` if there is none.
[[nodiscard]] CLI::App& parsed_subcommand(CLI::App& app);
/// Returns the files that the parsed subcommand reads and writes: those in options marked by `reads`,
/// `writes` or a similar function.
[[nodiscard]] std::vector<NamedFile> files_of(CLI::App& app);
/// Throws Error(wrong_arguments) if an option has an empty value, for example because a shell variable is not
/// set. Without this check, an output file with an empty name would silently not be written.
void refuse_empty_values(CLI::App& app);
/// Returns the options and input files that determine the result of the parsed subcommand.
[[nodiscard]] AskedFor asked_for(CLI::App& root);

/// Returns the words of the command line, with which the command can be run again. Leaves out --share,
/// --dry-run, --json, --restart and the options that name outputs.
[[nodiscard]] std::vector<std::string> words_of(CLI::App& app);

}  // namespace postlens
