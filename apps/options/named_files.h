// The files that a command line names. A file that is written must not be read, and must not be written
// twice.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct NamedFile {
    std::string option;  ///< name of the option for messages
    std::string path;
    bool written = false;
    /// With --frames, `numbered` allows placeholders for the frame number in the file name. `hashes` also
    /// allows # as a placeholder (frame_range.h).
    bool numbered = false, hashes = false;
};

/// Throws Error(wrong_arguments) if a file that is written occurs twice in `files`, for any frame of a range.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
