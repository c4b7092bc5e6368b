// The files that a command line names: none may be written that is also read, or written twice.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct NamedFile {
    std::string option;  ///< as messages call it
    std::string path;
    bool written = false;
    /// With --frames: the name may hold the frame's number, also as # (frame_range.h).
    bool numbered = false, hashes = false;
};

/// Throws Error(wrong_arguments) where a file that is written has two names among these; of a range for all
/// its frames.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
