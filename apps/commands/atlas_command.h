// The command `chart --atlas`. It runs the atlas of failure, a collection of scenes in which the methods
// fail.
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
