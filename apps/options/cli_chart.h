// The options of `chart`.
#pragma once

#include "apps/options/cli_options.h"

namespace postlens {

void add_chart_command(CLI::App& root, ParsedCommand& common);

}  // namespace postlens
