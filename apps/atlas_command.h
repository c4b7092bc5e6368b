// `chart --atlas`: its options, and what it gives back.
#pragma once

#include <string>

#include "apps/command.h"

namespace postlens {

struct AtlasOptions {
    std::string cases = "tests/stability";  ///< a folder
    std::string output;                     ///< a folder
    bool restart = false;
};

[[nodiscard]] CommandResult run_atlas_command(const AtlasOptions& options);

}  // namespace postlens
