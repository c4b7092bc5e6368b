#include "pictures/foreign/foreign_colours.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pictures/foreign/channel_groups.h"
#include "pictures/foreign/channel_names.h"

namespace postlens {
namespace {

/// Accepted names of colour channels. A layer must have all three names of one row.
constexpr std::array<std::array<const char*, 3>, 4> colour_names{
    {{"R", "G", "B"}, {"r", "g", "b"}, {"red", "green", "blue"}, {"Red", "Green", "Blue"}}};

/// Returns the names of a layer's three colour channels, or empty if one of them is missing.
std::optional<std::array<std::string, 3>> colours_of(const ForeignPart& part, const std::string& layer) {
    for (const auto& names : colour_names) {
        std::array<std::string, 3> out{layer + names[0], layer + names[1], layer + names[2]};
        if (std::all_of(out.begin(), out.end(), [&](const std::string& name) { return part.has(name); }))
            return out;
    }
    return std::nullopt;
}

/// Priority of a layer whose channels hold data, not colours.
constexpr int data_rank = 4;

/// Returns true if the name of the layer, or of its part, says that the channels are data (such as normals),
/// not colours. The part's name counts only if there are several parts.
bool holds_data(const ForeignFile& file, std::size_t part, const std::string& layer) {
    const bool only = std::count_if(file.parts().begin(), file.parts().end(),
                                    [](const ForeignPart& p) { return p.use == PartUse::picture; }) == 1;
    const std::vector<std::string> words = words_of(only ? layer : file.parts()[part].name + "." + layer);
    const bool matte = std::any_of(words.begin(), words.end(), [](const std::string& w) {
        return w.find("crypto") != std::string::npos;
    });
    return matte || names_vectors(words) || has_any_word(words, {"uv"}) ||
           std::any_of(words.begin(), words.end(),
                       [](const std::string& w) { return has_word(depth_words, w); });
}

/// Returns the priority of a layer as the source of colours. Lower is better.
int rank(const ForeignFile& file, std::size_t part, const std::string& layer) {
    if (holds_data(file, part, layer)) return data_rank;
    if (layer.empty()) return 0;
    const std::vector<std::string> words = words_of(layer);
    if (has_any_word(words, {"combined"})) return 1;
    return has_any_word(words, {"rgba", "beauty", "color", "ci"}) ? 2 : 3;
}

/// Returns how badly a layer of colours fits the name `asked`, which the user requested:
/// - 0: the file part, the stereo view or the layer has this name, the layer's name begins with it, or
///   `asked` is empty.
/// - 1: the names of the part, view and layer together contain all words of `asked`, in any order.
/// - 2: it does not fit.
int misfit(const ForeignFile& file, std::size_t part_number, const std::string& layer,
           const std::string& asked) {
    const ForeignPart& part = file.parts()[part_number];
    if (asked.empty() || part.name == asked || part.view == asked) return 0;
    if (!part.views.empty() && part.views[0] == asked && layer.empty()) return 0;
    if (layer == asked + "." || layer.starts_with(asked + ".")) return 0;
    const ChannelGroup group = channel_group(file, part_number, layer, colour_words);
    if (group.view == asked) return 0;
    std::vector<std::string> words = words_of(part.name + "." + layer + "." + group.view);
    const std::vector<std::string> wanted = words_of(asked);
    const bool all = std::all_of(wanted.begin(), wanted.end(), [&](const std::string& w) {
        return std::find(words.begin(), words.end(), w) != words.end();
    });
    return all && !wanted.empty() ? 1 : 2;
}

/// An owner identifies the layer to which a channel belongs. Colours and a depth belong together if their
/// owners are equal. An owner consists of the file part (only for deep images), the stereo view, and the
/// words of the layer's name.
using Owner = std::tuple<std::optional<std::size_t>, std::string, std::vector<std::string>>;

Owner owner_of(const ForeignFile& file, const ChannelGroup& group) {
    // In a deep image, colours and depth must be in the same part, because each part has its own samples.
    const bool deep = file.parts()[group.part].deep;
    return {deep ? std::optional(group.part) : std::nullopt, group.view, group.layer};
}

/// Returns the layers that have a depth channel.
std::set<Owner> owners_of_depths(const ForeignFile& file) {
    std::set<Owner> out;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        if (file.parts()[i].use != PartUse::picture) continue;
        for (const std::string& name : file.parts()[i].channels) {
            if (const auto depth = depth_candidate(file, i, name)) out.insert(owner_of(file, depth->group));
        }
    }
    return out;
}

/// Returns the layer that best fits the name `asked`, which the user requested, or empty if no layer fits.
/// The layer is returned as the index of its file part and the prefix of its channel names. `layers_of` lists
/// the layers of a part that are considered.
template <typename LayersOf>
std::optional<std::pair<std::size_t, std::string>> best_layer(const ForeignFile& file,
                                                              const std::string& asked,
                                                              const LayersOf& layers_of) {
    const auto views = file.views();
    const std::set<Owner> with_depth = owners_of_depths(file);
    std::optional<std::pair<std::size_t, std::string>> best;
    std::tuple<int, bool, std::size_t, int, std::size_t, bool, std::size_t> least{2, false, 0, 0,
                                                                                  0, false, 0};
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        if (file.parts()[i].use != PartUse::picture) continue;
        for (const std::string& layer : layers_of(file.parts()[i])) {
            const ChannelGroup group = channel_group(file, i, layer, colour_words);
            // A stereo file lists its views in the attribute `multiView`. If a file part does not state its
            // view, the names of its channels may state it, for example "left.R". Of layers that differ only
            // in the view, the one of the first listed view is preferred.
            const auto view = std::find(views.begin(), views.end(), group.view);
            const bool by_name = file.parts()[i].view.empty() && view != views.end();
            // The name `asked`, which the user requested, may match several layers. For example, "ViewLayer"
            // matches the layer ViewLayer, and also ViewLayer.001, whose name consists of two words. The
            // layer name with the fewest words is then preferred, because it is closest to the request.
            const std::size_t words = asked.empty() ? 0 : group.layer.size();
            const int kind = rank(file, i, layer);
            const std::tuple order{misfit(file, i, layer, asked),
                                   kind == data_rank,
                                   words,
                                   kind,
                                   by_name ? static_cast<std::size_t>(view - views.begin()) : 0,
                                   !with_depth.contains(owner_of(file, group)),
                                   group.layer.size()};
            if (order < least) {
                least = order;
                best = {i, layer};
            }
        }
    }
    return best;
}

/// Returns the layers that have luminance, or alpha and depth.
ChannelNames grey_layers(const ForeignPart& part) {
    ChannelNames out;
    for (const std::string& name : part.channels) {
        const auto [layer, letter] = split_channel(name);
        if (letter == "Y" || (letter == "A" && part.has(layer + "Z"))) out.push_back(layer);
    }
    return out;
}

}  // namespace

void find_colours(const ForeignFile& file, const std::string& asked, ForeignChannels& out) {
    if (const auto best = best_layer(file, asked, colour_layers)) {
        const ForeignPart& part = file.parts()[best->first];
        std::tie(out.part, out.layer) = *best;
        const auto names = colours_of(part, out.layer).value();
        out.r = names[0];
        out.g = names[1];
        out.b = names[2];
        return;
    }
    const auto grey = best_layer(file, asked, grey_layers);
    if (!grey) {
        ChannelNames names;
        for (const ForeignPart& part : file.parts())
            names.insert(names.end(), part.channels.begin(), part.channels.end());
        fail(ExitCode::invalid_input, "{}: no colours{} (got channels {}; expected R, G and B)", file.name(),
             asked.empty() ? "" : " in " + asked, listed(names));
    }
    const ForeignPart& part = file.parts()[grey->first];
    std::tie(out.part, out.layer) = *grey;
    out.r = out.g = out.b = first_channel(part, {out.layer + "Y"});
    const std::string ry = out.layer + "RY", by = out.layer + "BY";
    if (out.r.empty() || part.deep) return;
    if (part.has(ry) && part.has(by)) {
        out.ry = ry;
        out.by = by;
    } else if (part.has(ry) || part.has(by)) {
        out.assumed.push_back(fmt::format("{} is left aside without {}: the picture is grey",
                                          part.has(ry) ? ry : by, part.has(ry) ? by : ry));
    }
}

std::vector<std::string> colour_layers(const ForeignPart& part) {
    ChannelNames out;
    for (const std::string& name : part.channels) {
        const auto words = split_channel(name);
        const bool red = std::any_of(colour_names.begin(), colour_names.end(),
                                     [&](const auto& names) { return words.second == names[0]; });
        const std::string& layer = words.first;
        if (red && colours_of(part, layer) && std::find(out.begin(), out.end(), layer) == out.end())
            out.push_back(layer);
    }
    return out;
}

std::vector<ChannelGroup> colour_groups(const ForeignFile& file) {
    std::vector<ChannelGroup> out;
    for (std::size_t i = 0; i < file.parts().size(); ++i) {
        if (file.parts()[i].use != PartUse::picture) continue;
        for (const std::string& layer : colour_layers(file.parts()[i])) {
            if (!holds_data(file, i, layer)) out.push_back(channel_group(file, i, layer, colour_words));
        }
    }
    return out;
}

}  // namespace postlens
