#include "apps/options/named_files.h"

#include <unordered_map>

#include "apps/options/frame_range.h"
#include "core/error.h"
#include "core/files/file_identity.h"

namespace postlens {
namespace {

class FilesSeen {
  public:
    void add(const NamedFile& file, const std::string& path) {
        const auto [known, is_new] = first_.try_emplace(file_identity(path), &file);
        if (is_new) return;
        const NamedFile& other = *known->second;
        if (!file.written && !other.written) return;
        const bool also_read = !file.written || !other.written;
        const NamedFile& output = file.written ? file : other;
        const NamedFile& same = file.written ? other : file;
        fail(ExitCode::wrong_arguments, "{}: would overwrite {} {} (got {}; expected another file)",
             output.option, also_read ? "the input" : "the output", same.option, path);
    }

  private:
    std::unordered_map<std::string, const NamedFile*> first_;  ///< first use of each file, by its identity
};

}  // namespace

void refuse_shared_files(const std::vector<NamedFile>& files, const std::optional<std::vector<int>>& frames) {
    FilesSeen seen;
    for (const NamedFile& file : files) {
        if (!frames || !file.numbered) {
            seen.add(file, file.path);
            continue;
        }
        const FrameName name(file.path, file.hashes);
        // If the file name contains no placeholder for the frame number, every frame uses the same file. So
        // it is added to the list `seen` once, and not once per frame.
        if (!name.has_number()) {
            seen.add(file, file.path);
            continue;
        }
        for (const int frame : *frames) seen.add(file, name.of(frame));
    }
}

}  // namespace postlens
