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
    /// `numbered` allows placeholders such as %04d for the frame number, if --frames is given. `hashes` also
    /// allows # as a placeholder (frame_range.h).
    bool numbered = false, hashes = false;
};

/// Throws Error(wrong_arguments) if an output file is also an input, or is written twice. The files of all
/// `frames` are checked.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
