#include "pictures/foreign/foreign_channels.h"

#include <algorithm>
#include <fmt/ranges.h>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "pictures/foreign/channel_names.h"
#include "pictures/foreign/foreign_colours.h"

namespace postlens {
namespace {

const ChannelNames alpha_names{"A", "a", "alpha", "Alpha"};

std::string behind(const ForeignPart& part, const std::string& layer, const ChannelNames& letters) {
    ChannelNames names;
    for (const std::string& letter : letters) names.push_back(layer + letter);
    return first_channel(part, names);
}

/// Returns the channels that may contain the pass `use` of the image with the colours `colours`. A pass is an
/// additional image, such as depth or ids. If the channel `name` fits the pass, the function `add(part, name,
/// out)` appends it to `out`.
template <typename Add>
std::vector<GroupCandidate> candidates_of(const ForeignFile& file, const ForeignChannels& colours,
                                          PartUse use, const Add& add) {
    const bool own_file = file.has_own_file(use);
    const bool deep = file.parts()[colours.part].deep;
    std::vector<GroupCandidate> out;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        const ForeignPart& part = file.parts()[i];
        if (part.use != (own_file ? use : PartUse::picture)) continue;
        if (own_file ? part.deep : part.deep != deep || (deep && i != colours.part)) continue;
        for (const std::string& name : part.channels) add(i, name, out);
    }
    return out;
}

/// Returns the name of a layer for messages.
std::string title(const ChannelGroup& group) {
    std::string out = fmt::format("{}", fmt::join(group.layer, "."));
    if (!group.view.empty()) out += (out.empty() ? "view " : " of view ") + group.view;
    return out.empty() ? "the whole picture" : out;
}

class Finder {
  public:
    Finder(const ForeignFile& file, const ForeignChoice& choice, ForeignChannels& out)
        : file_(file),
          choice_(choice),
          out_(out),
          part_(file.parts()[out.part]),
          own_(channel_group(file, out.part, out.layer, colour_words)),
          pictures_(colour_groups(file)) {}

    void find_alpha() {
        out_.alpha_part = out_.part;
        out_.a = behind(part_, out_.layer, alpha_names);
        // Channels of colours and alpha are named either R, G, B, A or r, g, b, a. So a channel "a" is
        // accepted as alpha only if the red channel is named "r". Beside "R", a channel "a" must have another
        // meaning.
        if (out_.a == out_.layer + "a" && out_.r != out_.layer + "r") out_.a.clear();
        if (!out_.a.empty() || part_.deep) return;
        const auto found =
            candidates_of(file_, out_, PartUse::picture, [&](std::size_t part, const auto& name, auto& to) {
                const auto [before, letter] = split_channel(name);
                const ChannelGroup group = channel_group(file_, part, before, alpha_words);
                const std::string last = lower_case(letter);
                const bool is_a = letter == "A" || (letter == "a" && out_.r == out_.layer + "r");
                if (is_a || last == "alpha" || (group.has_pass && last == "y"))
                    to.push_back({group, name, 0});
            });
        const auto match = match_group(found, own_, pictures_);
        // The alpha channel must be in the same layer as the colours, because the alpha of another layer
        // could make opaque pixels transparent.
        if (!match || match->surmised || found[match->candidate].group.layer != own_.layer) return;
        out_.alpha_part = found[match->candidate].group.part;
        out_.a = found[match->candidate].name;
    }

    void find_depth() {
        out_.depth_part = out_.part;
        if (!choice_.depth_channel.empty()) return find_named(choice_.depth_channel, PartUse::depth);
        const std::vector<GroupCandidate> found = depths();
        const bool own_file = file_.has_own_file(PartUse::depth);
        auto match = match_group(found, own_, pictures_);
        if (!match && own_file && !found.empty()) match = GroupMatch{0, true};
        if (!match) {
            if (own_file) {
                fail(ExitCode::invalid_input,
                     "{}: no depth (got channels {}; expected Z, or --depth-channel)",
                     file_name(PartUse::depth), listed(channels_of(PartUse::depth)));
            }
            if (!found.empty()) {
                out_.assumed.push_back(
                    fmt::format("{} is not taken as the depth: it belongs to {}, the "
                                "colours to {} (--depth-channel, --layer)",
                                found[0].name, title(found[0].group), title(own_)));
            }
            return;
        }
        const GroupCandidate& depth = found[match->candidate];
        out_.z = depth.name;
        out_.depth_part = depth.group.part;
        if (match->surmised && !own_file) {
            out_.assumed.push_back(fmt::format("{} of {} is taken as the depth: {} has none of its own",
                                               depth.name, title(depth.group), title(own_)));
        }
    }

    void find_ids() {
        out_.id_part = out_.part;
        if (choice_.ids == ForeignChoice::no_ids) return;
        ChannelNames sets;
        std::string left;  // existing channels that belong to another layer
        if (!part_.deep) take_matte(sets, left);
        // `out_.problems` now reports all Cryptomattes (sets of object masks) that cannot be used. If the
        // user named the channel with the object ids (`choice_.ids`), no other Cryptomatte is needed, so the
        // reports are moved to `unusable` and cause no warning.
        const ChannelNames unusable = choice_.ids.empty() ? ChannelNames() : std::exchange(out_.problems, {});
        if (out_.matte) return;
        if (!choice_.ids.empty()) return find_named_ids(unusable, std::move(sets));
        const std::vector<GroupCandidate> found = ids();
        const auto match = match_group(found, own_, pictures_);
        if (match) {
            const GroupCandidate& id = found[match->candidate];
            out_.id = id.name;
            out_.id_part = id.group.part;
            return;
        }
        if (left.empty() && !found.empty())
            left = fmt::format("ids {} belong to {}", found[0].name, title(found[0].group));
        if (!left.empty())
            out_.problems.push_back(left +
                                    fmt::format(", not to {}: they are left aside (--ids)", title(own_)));
    }

  private:
    [[nodiscard]] ChannelNames channels_of(PartUse use) const {
        ChannelNames out;
        for (const ForeignPart& part : file_.parts()) {
            if (part.use == use) out.insert(out.end(), part.channels.begin(), part.channels.end());
        }
        return out;
    }
    [[nodiscard]] const std::string& file_name(PartUse use) const {
        for (std::size_t i = 0; i < file_.parts().size(); ++i) {
            if (file_.parts()[i].use == use) return file_.name_of(i);
        }
        return file_.name();
    }

    /// Returns the index of the file part that has the channel `name` of the pass `use`, such as depth. The
    /// part with the colours is preferred, and then a part with the same stereo view. Returns empty if no
    /// part has it.
    [[nodiscard]] std::optional<std::size_t> part_with(const std::string& name, PartUse use) const {
        // If the user gave a separate file for this pass, only the parts of this file are searched.
        const bool own_file = file_.has_own_file(use);
        if (!own_file && part_.has(name)) return out_.part;
        if (!own_file && part_.deep) return std::nullopt;
        std::optional<std::size_t> other;
        for (std::size_t i = 0; i < file_.parts().size(); ++i) {
            const ForeignPart& part = file_.parts()[i];
            if (part.use != (own_file ? use : PartUse::picture) || part.deep || !part.has(name)) continue;
            if (part.view == part_.view) return i;
            if (!other) other = i;
        }
        return other;
    }

    void find_named(const std::string& name, PartUse use) {
        const auto part = part_with(name, use);
        if (!part) {
            const bool own_file = file_.has_own_file(use);
            fail(ExitCode::invalid_input, "{}: no channel {} (got {}; expected what --depth-channel names)",
                 file_name(use), name, listed(own_file ? channels_of(use) : part_.channels));
        }
        out_.z = name;
        out_.depth_part = *part;
    }

    [[nodiscard]] std::vector<GroupCandidate> depths() const {
        const bool own_file = file_.has_own_file(PartUse::depth);
        auto found =
            candidates_of(file_, out_, PartUse::depth, [&](std::size_t part, const auto& name, auto& to) {
                auto depth = depth_candidate(file_, part, name);
                if (!depth) return;
                const auto [before, letter] = split_channel(name);
                if (lower_case(letter) == "z" && part == out_.part && before == out_.layer) depth->rank = 0;
                to.push_back(*std::move(depth));
            });
        if (!own_file || !found.empty()) return found;
        // No channel is named like a depth, but the user gave a separate file for depths. So the only channel
        // of a file part is accepted, and also a channel R, Y or V, because some programs write depths as a
        // grey RGB image.
        return candidates_of(file_, out_, PartUse::depth, [&](std::size_t part, const auto& name, auto& to) {
            const std::string letter = split_channel(name).second;
            if (file_.parts()[part].channels.size() == 1 || letter == "R" || letter == "Y" || letter == "V")
                to.push_back({channel_group(file_, part, "", depth_words), name, 5});
        });
    }

    [[nodiscard]] std::vector<GroupCandidate> ids() const {
        return candidates_of(file_, out_, PartUse::ids, [&](std::size_t part, const auto& name, auto& to) {
            const auto [before, letter] = split_channel(name);
            const auto is_id = [](std::string word) {
                word = lower_case(std::move(word));
                std::erase(word, '_');
                return word == "id" || word == "objectid" || word == "indexob";
            };
            const std::string pass = before.empty()
                                         ? file_.parts()[part].name
                                         : split_channel(before.substr(0, before.size() - 1)).second;
            const bool component = letter == "X" || letter == "V" || letter == "Y";
            if (is_id(letter) || (component && is_id(pass)))
                to.push_back({channel_group(file_, part, before, id_words), name, is_id(letter) ? 0 : 1});
        });
    }

    void take_matte(ChannelNames& sets, std::string& left) {
        Cryptomattes found = find_cryptomattes(file_, out_.part);
        out_.problems = std::move(found.problems);
        std::vector<GroupCandidate> candidates;
        for (const Cryptomatte& set : found.usable) {
            sets.push_back(set.name);
            // Each candidate is a Cryptomatte (set of object masks) that may belong to the selected colours.
            // match_group() would prefer a candidate in the file part of these colours. But a Cryptomatte may
            // be stored in another part, so all candidates get the part of the colours.
            candidates.push_back({cryptomatte_group(file_, set), set.name, 0});
            candidates.back().group.part = out_.part;
        }
        if (!choice_.ids.empty()) {
            for (Cryptomatte& set : found.usable) {
                if (set.name == choice_.ids && !out_.matte) out_.matte = std::move(set);
            }
        } else if (const auto match = match_group(candidates, own_, pictures_)) {
            out_.matte = std::move(found.usable[match->candidate]);
        } else if (!candidates.empty()) {
            left = fmt::format("Cryptomatte {} belongs to {}", sets[0], title(candidates[0].group));
        }
    }

    void find_named_ids(const ChannelNames& unusable, ChannelNames sets) {
        if (const auto part = part_with(choice_.ids, PartUse::ids)) {
            out_.id = choice_.ids;
            out_.id_part = *part;
            return;
        }
        for (const std::string& problem : unusable) {
            if (problem.starts_with("Cryptomatte " + choice_.ids + " "))
                fail(ExitCode::invalid_input, "{}: {}", file_.name(), problem);
        }
        const ChannelNames there =
            file_.has_own_file(PartUse::ids) ? channels_of(PartUse::ids) : part_.channels;
        sets.insert(sets.end(), there.begin(), there.end());
        fail(ExitCode::invalid_input, "{}: no ids {} (got {}; expected what --ids names)",
             file_name(PartUse::ids), choice_.ids, listed(sets));
    }

    const ForeignFile& file_;
    const ForeignChoice& choice_;
    ForeignChannels& out_;
    const ForeignPart& part_;
    ChannelGroup own_;
    std::vector<ChannelGroup> pictures_;
};

}  // namespace

std::string listed(std::span<const std::string> names) {
    constexpr std::size_t most = 24;
    const auto shown = names.first(std::min(most, names.size()));
    return fmt::format("{}{}", fmt::join(shown, ", "),
                       names.size() > most ? fmt::format(" and {} more", names.size() - most) : "");
}

ForeignFile open_foreign_file(const std::filesystem::path& path, const ForeignChoice& choice) {
    ForeignFile file(path);
    if (!choice.depth_file.empty()) file.attach(choice.depth_file, PartUse::depth);
    if (!choice.ids_file.empty()) file.attach(choice.ids_file, PartUse::ids);
    return file;
}

ForeignChannels find_foreign_channels(const ForeignFile& file, const ForeignChoice& choice) {
    ForeignChannels out;
    find_colours(file, choice.layer, out);
    const ForeignPart& part = file.parts()[out.part];
    Finder finder(file, choice, out);
    finder.find_alpha();
    finder.find_depth();
    if (part.deep) {
        // ZBack is the depth at which a deep sample ends. It must be in the same layer as Z.
        out.z_back = first_channel(part, {split_channel(out.z).first + "ZBack"});
        if (out.z.empty()) {
            fail(ExitCode::invalid_input, "{}: no depth (got channels {}; expected Z in a deep picture)",
                 file.name(), listed(part.channels));
        }
    }
    finder.find_ids();
    return out;
}

}  // namespace postlens
