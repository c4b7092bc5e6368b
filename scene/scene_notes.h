// Notes to the user about defaults, changes and skipped contents of a scene. Equal notes are merged and
// counted.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace postlens {

class SceneNotes {
  public:
    void add(const std::string& text);
    /// Appends all notes in the order in which they first occurred, as "FILE: text" or "FILE: text (N
    /// times)".
    void append_to(std::vector<std::string>& out, const std::filesystem::path& file) const;

  private:
    struct Note {
        std::string text;
        std::size_t count = 0;
    };
    std::map<std::string, std::size_t> place_;
    std::vector<Note> notes_;
};

/// Returns a name that is valid in a scene. Control characters are replaced by '?', and the name is cut to
/// 255 bytes. Returns `fallback` if `name` is empty.
[[nodiscard]] std::string printable_name(const std::string& name, const std::string& fallback);

}  // namespace postlens
