#include "motionblur/vectors/vector_channels.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/error.h"
#include "pictures/foreign/foreign_channels.h"

namespace postlens {
namespace {

/// Channel names and scale of the vectors that a program writes.
struct Convention {
    PassWords words;  ///< names of the pass; if empty, any pass matches, but only in a separate file
    const char *u, *v;
    glm::dvec2 scale;
    bool is_sure = true;  ///< false if programs use these names for different units and directions
};
constexpr std::array<std::string_view, 1> forward{"forward"}, vector{"vector"};
constexpr std::array<std::string_view, 4> motion{"motion", "*motionvector", "*motionvectors", "*velocity"};
constexpr std::array<std::array<const char*, 2>, 5> pairs{
    {{"x", "y"}, {"X", "Y"}, {"u", "v"}, {"U", "V"}, {"R", "G"}}};

std::vector<Convention> conventions(bool own_file) {
    std::vector<Convention> out{{forward, "u", "v", {1, -1}},
                                // Blender's channels (Z, W) hold this frame's position minus the next frame's
                                // position, to the right and upwards. The factors in braces convert them to
                                // the motion until the next frame, to the right and down.
                                {vector, "Z", "W", {-1, 1}},
                                {motion, "x", "y", {1, 1}}};
    for (const auto& [u, v] : std::span(pairs).subspan(1)) out.push_back({motion, u, v, {1, 1}, false});
    if (own_file) {
        for (const auto& [u, v] : pairs) out.push_back({{}, u, v, {1, 1}});
    }
    return out;
}

bool may_hold(const ForeignFile& file, std::size_t part) {
    const ForeignPart& p = file.parts()[part];
    return !p.deep && p.use == (file.has_own_file(PartUse::vectors) ? PartUse::vectors : PartUse::picture);
}

VectorChannels named(const ForeignFile& file, const ChannelGroup& own, const VectorChoice& choice) {
    const auto& [u, v] = *choice.channels;
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        const ForeignPart& part = file.parts()[i];
        if (!may_hold(file, i) || !part.has(u) || !part.has(v)) continue;
        // Selects the file part whose channels `u` and `v` contain the motion vectors. Of several parts that
        // have these channels, the part with the colours is preferred, and then a part with the same stereo
        // view as the colours.
        const auto better = [&](std::size_t one, std::size_t other) {
            const auto order = [&](std::size_t k) {
                return std::pair(k != own.part, file.parts()[k].view != file.parts()[own.part].view);
            };
            return order(one) < order(other);
        };
        if (!found || better(i, *found)) found = i;
    }
    if (!found) {
        std::vector<std::string> names;
        std::string missing = u, source = file.name();
        for (std::size_t i = 0; i < file.parts().size(); ++i) {
            if (!may_hold(file, i)) continue;
            source = file.name_of(i);
            if (file.parts()[i].has(u)) missing = v;
            names.insert(names.end(), file.parts()[i].channels.begin(), file.parts()[i].channels.end());
        }
        fail(ExitCode::invalid_input, "{}: no channel {} (got {}; expected what --vectors names)", source,
             missing, listed(names));
    }
    return {.part = *found, .u = u, .v = v, .scale = {1, 1}, .offset = {0, 0}, .assumed = {}};
}

}  // namespace

std::optional<VectorChannels> find_vector_channels(const ForeignFile& file, const ChannelGroup& own,
                                                   const VectorChoice& choice,
                                                   std::optional<ChannelGroup>& other) {
    other.reset();
    std::optional<VectorChannels> out;
    if (choice.channels) {
        out = named(file, own, choice);
    } else {
        const bool own_file = file.has_own_file(PartUse::vectors);
        const std::vector<Convention> known = conventions(own_file);
        std::vector<GroupCandidate> candidates;
        std::vector<VectorChannels> channels;
        for (std::size_t i = 0; i < file.parts().size(); ++i) {
            if (!may_hold(file, i)) continue;
            for (const std::string& name : file.parts()[i].channels) {
                const std::size_t dot = name.rfind('.') + 1;  // 0 without a dot
                const std::string before = name.substr(0, dot), letter = name.substr(dot);
                for (std::size_t k = 0; k < known.size(); ++k) {
                    const Convention& c = known[k];
                    if (letter != c.u || !file.parts()[i].has(before + c.v)) continue;
                    const ChannelGroup group =
                        channel_group(file, i, before, c.words.empty() ? PassWords(vector_words) : c.words);
                    if (!c.words.empty() && !group.has_pass) continue;
                    candidates.push_back({group, name, static_cast<int>(k)});
                    channels.push_back({.part = i,
                                        .u = name,
                                        .v = before + c.v,
                                        .scale = c.scale,
                                        .offset = {0, 0},
                                        .assumed = {}});
                }
            }
        }
        auto match = match_group(candidates, own, colour_groups(file));
        if (!match && own_file && !candidates.empty()) {
            const auto best = std::min_element(
                candidates.begin(), candidates.end(),
                [](const GroupCandidate& a, const GroupCandidate& b) { return a.rank < b.rank; });
            match = GroupMatch{static_cast<std::size_t>(best - candidates.begin()), false};
        }
        if (!match) {
            if (!candidates.empty()) other = candidates[0].group;
            return std::nullopt;
        }
        out = channels[match->candidate];
        const std::string names = out->u + " and " + out->v;
        if (match->surmised && !own_file) {
            out->assumed = names + " are taken as the motion: the colours have none of their own";
        } else if (!known[static_cast<std::size_t>(candidates[match->candidate].rank)].is_sure &&
                   !choice.scale) {
            out->assumed = names + " are taken as px to the right and down (--vector-scale)";
        }
    }
    out->scale = choice.scale.value_or(out->scale);
    out->offset = choice.offset.value_or(out->offset);
    return out;
}

}  // namespace postlens
