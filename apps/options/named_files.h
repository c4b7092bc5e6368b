// Checks the files that a command line names: no file may be both read and written, or written twice.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace postlens {

struct NamedFile {
    std::string option;  ///< name of the option for messages
    std::string path;
    bool written = false;
    /// If `numbered` is true, `path` may contain a placeholder such as %04d, which --frames replaces by the
    /// number of each frame. If `hashes` is true too, the placeholder may also be a sequence of #, one for
    /// each digit.
    bool numbered = false, hashes = false;
};

/// Throws Error(wrong_arguments) if an output file of any frame is also an input, or is written twice.
void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames);

}  // namespace postlens
