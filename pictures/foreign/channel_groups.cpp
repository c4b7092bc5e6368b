#include "pictures/foreign/channel_groups.h"

#include <algorithm>
#include <cctype>
#include <tuple>

#include "core/text.h"
#include "pictures/foreign/channel_names.h"

namespace postlens {
namespace {

bool contains(const std::vector<std::string>& sorted, const std::vector<std::string>& some) {
    return std::includes(sorted.begin(), sorted.end(), some.begin(), some.end());
}

std::vector<std::string> sorted_words(std::string_view name) {
    std::vector<std::string> out = words_of(name);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

/// Returns true if a name was invented for an unnamed part of an OpenEXR file: "subimage" or "part", followed
/// by a number. Libraries that write such files use these names.
bool is_number_of_part(const std::string& word) {
    for (const std::string_view stem : {"subimage", "part"}) {
        if (word.size() > stem.size() && word.starts_with(stem) &&
            std::all_of(word.begin() + static_cast<std::ptrdiff_t>(stem.size()), word.end(),
                        [](unsigned char c) { return std::isdigit(c) != 0; }))
            return true;
    }
    return false;
}

}  // namespace

bool has_word(PassWords words, std::string_view word) {
    return std::any_of(words.begin(), words.end(), [&](std::string_view w) {
        return w.starts_with('*') ? word.ends_with(w.substr(1)) : word == w;
    });
}

std::vector<std::string> words_of(std::string_view name) {
    std::vector<std::string> out;
    bool inside = false;
    for (const char c : name) {
        const auto letter = static_cast<unsigned char>(c);
        // Bytes of non-ASCII characters count as letters.
        if (letter < 128 && std::isalnum(letter) == 0) {
            inside = false;
            continue;
        }
        if (!inside) out.emplace_back();
        inside = true;
        out.back() += letter < 128 ? static_cast<char>(std::tolower(letter)) : c;
    }
    return out;
}

ChannelGroup channel_group(const ForeignFile& file, std::size_t part, std::string_view prefix,
                           PassWords pass) {
    const ForeignPart& p = file.parts()[part];
    ChannelGroup out;
    out.part = part;
    std::vector<std::string> words = sorted_words(p.name + "." + std::string(prefix));
    out.view = p.view;
    for (const std::string& view : file.views()) {
        const std::vector<std::string> names = sorted_words(view);
        if (names.empty() || !contains(words, names)) continue;
        if (out.view.empty()) out.view = view;
        if (out.view != view) continue;
        std::erase_if(words, [&](const std::string& w) {
            return std::find(names.begin(), names.end(), w) != names.end();
        });
    }
    if (out.view.empty() && !p.views.empty()) out.view = p.views[0];
    std::erase_if(words, [&](const std::string& w) {
        const bool of_pass = has_word(pass, w);
        out.has_pass = out.has_pass || of_pass;
        return of_pass || has_word(colour_words, w) || is_number_of_part(w);
    });
    out.layer = std::move(words);
    return out;
}

bool names_vectors(const std::vector<std::string>& words) {
    return has_any_word(words, {"normal", "normals", "position"}) ||
           std::any_of(words.begin(), words.end(),
                       [](const std::string& w) { return has_word(vector_words, w); });
}

std::optional<GroupCandidate> depth_candidate(const ForeignFile& file, std::size_t part,
                                              const std::string& name) {
    const ForeignPart& p = file.parts()[part];
    const auto [before, letter] = split_channel(name);
    const std::string last = lower_case(letter);
    const ChannelGroup group = channel_group(file, part, before, depth_words);
    // If there are also channels X and Y, the channel Z is a component of a vector, not a depth.
    const bool has_x =
        p.has(before + (letter == "z" ? "x" : "X")) && p.has(before + (letter == "z" ? "y" : "Y"));
    if (last == "z" && (group.has_pass || !has_x)) {
        if (names_vectors(group.layer)) return {};
        return GroupCandidate{group, name, group.has_pass ? 2 : 1};
    }
    if ((group.has_pass && (last == "v" || last == "y")) || (last != "z" && has_word(depth_words, last)))
        return GroupCandidate{group, name, 3};
    if (group.has_pass && last == "r") return GroupCandidate{group, name, 4};
    // The renderer Mitsuba stores depth in a channel with the name AOV.T, where AOV is any layer name. But if
    // the layer also has a channel S, S and T are texture coordinates, so T is not a depth.
    if (letter == "T" && !before.empty() && !p.has(before + "S") && !names_vectors(group.layer))
        return GroupCandidate{group, name, 5};
    return {};
}

std::optional<GroupMatch> match_group(std::span<const GroupCandidate> candidates, const ChannelGroup& own,
                                      std::span<const ChannelGroup> pictures) {
    const auto has_colours = [&](const ChannelGroup& group) {
        return std::any_of(pictures.begin(), pictures.end(), [&](const ChannelGroup& p) {
            return p.view == group.view && p.layer == group.layer;
        });
    };
    using Order = std::tuple<std::size_t, bool, int>;
    std::optional<std::pair<Order, std::size_t>> best;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const ChannelGroup& g = candidates[i].group;
        if (g.view != own.view || !contains(own.layer, g.layer)) continue;
        const Order order{own.layer.size() - g.layer.size(), g.part != own.part, candidates[i].rank};
        if (!best || order < best->first) best = {order, i};
    }
    if (best) {
        const ChannelGroup& g = candidates[best->second].group;
        return GroupMatch{best->second, g.layer != own.layer && has_colours(g)};
    }
    std::optional<std::size_t> only;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const ChannelGroup& g = candidates[i].group;
        if ((!g.view.empty() && !own.view.empty() && g.view != own.view) || has_colours(g)) continue;
        if (only && (candidates[*only].group.layer != g.layer || candidates[*only].group.part != g.part))
            return std::nullopt;
        if (!only || candidates[i].rank < candidates[*only].rank) only = i;
    }
    if (!only) return std::nullopt;
    return GroupMatch{*only, true};
}

}  // namespace postlens
