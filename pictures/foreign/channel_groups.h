// Finds the view and the layer of channels in another program's OpenEXR file, by the words in the names of
// channels and parts.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Lower-case words of channel names that name a pass, such as depth. The other words of a channel name are
/// the name of a layer.
using PassWords = std::span<const std::string_view>;

inline constexpr std::string_view colour_words[]{"rgba",  "rgb",    "combined", "beauty",
                                                 "color", "colour", "image",    "ci"};
inline constexpr std::string_view depth_words[]{"depth",
                                                "z",
                                                "zdepth",
                                                "depthz",
                                                "zbuffer",
                                                "zbuf",
                                                "pz",
                                                "*zdepth",
                                                "*worlddepth",
                                                "*scenedepth",
                                                "*scenedepthworldunits",
                                                "*cameradepth"};
inline constexpr std::string_view alpha_words[]{"alpha", "a", "rgba"};
inline constexpr std::string_view id_words[]{"id", "ids", "object", "objectid", "indexob"};
inline constexpr std::string_view vector_words[]{"vector",        "vectors",        "forward",  "motion",
                                                 "*motionvector", "*motionvectors", "*velocity"};

/// The view (such as the left eye) and the layer of a channel. Programs write the words of a channel name in
/// different orders (LAYER.depth.Z or depth.LAYER.Z). The words in `layer` are sorted, so that the order does
/// not matter.
struct ChannelGroup {
    std::size_t part = 0;
    std::string view;                ///< from the part, its name, or the first of `multiView`; may be empty
    std::vector<std::string> layer;  ///< words, sorted, lower case; empty for the whole image
    bool has_pass = false;           ///< the names contain a word that names the pass
};

/// Returns the stereo view and the layer of the channels whose names begin with `prefix`. For example, the
/// prefix "left.diffuse." has the view left and the layer diffuse. An empty prefix means channels without a
/// layer. `pass` lists the words that name a pass, such as depth, and are not a part of the layer's name.
[[nodiscard]] ChannelGroup channel_group(const ForeignFile& file, std::size_t part, std::string_view prefix,
                                         PassWords pass);

/// Splits a name into words in lower case, at all characters except letters and digits.
[[nodiscard]] std::vector<std::string> words_of(std::string_view name);

/// A channel that may belong to the selected colours.
struct GroupCandidate {
    ChannelGroup group;
    std::string name;  ///< name for messages
    int rank = 0;      ///< lower is better; decides between equal layers
};

struct GroupMatch {
    std::size_t candidate = 0;
    bool surmised = false;  ///< the names do not prove that the channel belongs to the colours
};

/// Returns true if the words of a channel's name (words_of) name a normal, a position or a motion.
[[nodiscard]] bool names_vectors(const std::vector<std::string>& words);

/// Returns true if `word`, a word of a channel's name, is one of `words`. These words all name the same pass,
/// for example depth.
[[nodiscard]] bool has_word(PassWords words, std::string_view word);

/// If a channel of the file part `part` is named like a depth, returns it as a candidate for the depth of an
/// image layer. Otherwise, returns empty. match_group() then selects the candidate that belongs to the
/// selected colours.
[[nodiscard]] std::optional<GroupCandidate> depth_candidate(const ForeignFile& file, std::size_t part,
                                                            const std::string& name);

/// Selects the channel that belongs to the colours with the view and layer `own`. `pictures` are the groups
/// of all colours in the file.
///
/// The channel must have the same view as the colours. All words of the channel's layer must also be in the
/// layer of the colours. Of several such channels, the one whose layer has the most words is selected. In
/// case of a tie, a channel in the same part as the colours is preferred, and then the lowest rank. The match
/// is marked `surmised` if the channel is in another layer than `own` and that layer has colours, too.
///
/// If there is no such channel, the function looks at channels that belong neither to other colours nor to
/// another view. If these are all in one part and one layer, the one with the lowest rank is selected, and
/// the match is marked `surmised`. Otherwise the result is empty.
[[nodiscard]] std::optional<GroupMatch> match_group(std::span<const GroupCandidate> candidates,
                                                    const ChannelGroup& own,
                                                    std::span<const ChannelGroup> pictures);

}  // namespace postlens
