#include "scene/scene_notes.h"

#include <fmt/format.h>

#include "core/text.h"

namespace postlens {

void SceneNotes::add(const std::string& text) {
    const auto [at, is_new] = place_.try_emplace(text, notes_.size());
    if (is_new) notes_.push_back({text, 0});
    ++notes_[at->second].count;
}

void SceneNotes::append_to(std::vector<std::string>& out, const std::filesystem::path& file) const {
    for (const Note& n : notes_) {
        out.push_back(n.count == 1 ? fmt::format("{}: {}", file.string(), n.text)
                                   : fmt::format("{}: {} ({} times)", file.string(), n.text, n.count));
    }
}

std::string printable_name(const std::string& name, const std::string& fallback) {
    constexpr std::size_t most = 255;
    const std::string out = printable(name.substr(0, most));
    return out.empty() ? fallback : out;
}

}  // namespace postlens
