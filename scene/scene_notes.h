// Notes to the user about defaults, changes and skipped contents of a scene. Equal notes are counted.
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
    /// Appends all notes in the order of their first occurrence, as "FILE: text" or "FILE: text (N times)".
    void append_to(std::vector<std::string>& out, const std::filesystem::path& file) const;

  private:
    struct Note {
        std::string text;
        std::size_t count = 0;
    };
    std::map<std::string, std::size_t> place_;
    std::vector<Note> notes_;
};

/// Returns a name that is valid in a scene: at most 255 bytes, with control characters replaced by '?'.
/// Returns `fallback` if `name` is empty.
[[nodiscard]] std::string printable_name(const std::string& name, const std::string& fallback);

}  // namespace postlens
