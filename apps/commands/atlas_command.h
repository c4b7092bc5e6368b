// The command `chart --atlas`. It makes images of scenes in which a method fails, and shows them on an HTML
// page.
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
