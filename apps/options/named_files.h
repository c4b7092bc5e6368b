// The files that a command line names. Checks that no file is both read and written, and that no file is
// written twice.
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

/// Throws Error(wrong_arguments) if a file that is written has a second use, in any frame of `frames`.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
