// The command `chart --atlas`, which runs an atlas of failure.
#pragma once

#include <string>

#include "apps/command.h"

namespace postlens {

struct AtlasOptions {
    std::string cases = "tests/stability";  ///< folder of the cases
    std::string output;                     ///< output folder
    bool restart = false;
};

[[nodiscard]] CommandResult run_atlas_command(const AtlasOptions& options);

}  // namespace postlens
