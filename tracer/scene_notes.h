// What a reader made up, changed or left out: said once for each kind, with a count.
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
    /// In the order of the first of each kind: "FILE: text", "FILE: text (N times)".
    void append_to(std::vector<std::string>& out, const std::filesystem::path& file) const;

  private:
    struct Note {
        std::string text;
        std::size_t count = 0;
    };
    std::map<std::string, std::size_t> place_;
    std::vector<Note> notes_;
};

/// A name from a file as names of scenes are: printable (other bytes become '?'), at most 255 bytes;
/// `fallback` for an empty one.
[[nodiscard]] std::string printable_name(const std::string& name, const std::string& fallback);

}  // namespace postlens
