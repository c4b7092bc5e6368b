// The files named on a command line. A written file must not be read as well, or be written twice.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct NamedFile {
    std::string option;  ///< name of the option for messages
    std::string path;
    bool written = false;
    /// With --frames, `numbered` allows placeholders for the frame number in the name, and `hashes` also
    /// allows # as a placeholder (frame_range.h).
    bool numbered = false, hashes = false;
};

/// Throws Error(wrong_arguments) if a written file occurs twice among these, for any frame of a range.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
