// The command `chart --atlas`. It makes images of a collection of scenes, each of which breaks a method, and
// shows them on a page.
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
