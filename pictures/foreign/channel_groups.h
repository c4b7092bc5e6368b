// Determines the view and the layer to which the channels of another program's OpenEXR file belong, from the
// words in the names of channels and parts.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Words, in lower case, that name the content of a channel instead of its layer.
using PassWords = std::span<const std::string_view>;

inline constexpr std::string_view colour_words[]{"rgba",  "rgb",    "combined", "beauty",
                                                 "color", "colour", "image",    "ci"};
inline constexpr std::string_view depth_words[]{"depth", "z",  "zdepth",     "depthz",    "zbuffer",
                                                "zbuf",  "pz", "vrayzdepth", "worlddepth"};
inline constexpr std::string_view alpha_words[]{"alpha", "a", "rgba"};
inline constexpr std::string_view id_words[]{"id", "ids", "object", "objectid", "indexob"};
inline constexpr std::string_view vector_words[]{"vector", "vectors", "forward", "motion", "velocity"};

/// View and layer of a channel, or of all channels of one pass (such as depth).
///
/// Programs order names differently: LAYER.depth.Z, depth.LAYER.Z, or a part depth_LAYER with a channel Z.
/// Therefore, the words of the part's name and of the channel's name (without its last word) form a set. The
/// layer is what remains of this set without the words that name the pass or the view. Words that name
/// colours are not part of a layer's name either: the Z of a part "rgba" belongs to the colours of that part.
struct ChannelGroup {
    std::size_t part = 0;
    std::string view;                ///< of the part or the name; else the first of `multiView`; else empty
    std::vector<std::string> layer;  ///< words, sorted, lower case; empty: the whole image
    bool has_pass = false;           ///< the names contain a word that names the pass
};

/// View and layer of the channels of a part whose names begin with `prefix`. The prefix includes its dot; an
/// empty prefix means no layer.
[[nodiscard]] ChannelGroup channel_group(const ForeignFile& file, std::size_t part, std::string_view prefix,
                                         PassWords pass);

/// Splits a name into words, in lower case. Every character that is not a letter or a digit separates words.
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

/// Whether the words of a name show that its channel is a component of a normal, a position or a motion.
[[nodiscard]] bool names_vectors(const std::vector<std::string>& words);

/// Returns the channel as a candidate for the depth, if its name is that of a depth; otherwise empty.
[[nodiscard]] std::optional<GroupCandidate> depth_candidate(const ForeignFile& file, std::size_t part,
                                                            const std::string& name);

/// Selects the channel that belongs to the colours of the group `own` (view and layer). The channel must have
/// the same view, and its layer must have no words that the colours' layer lacks. Of several such channels,
/// the one whose layer lacks the fewest words is selected, then one in the part of the colours, then the one
/// with the lowest rank. It is marked `surmised` if its own layer is a different one with colours. If there
/// is no such channel, candidates that belong to other colours or to another view are excluded. If the
/// remaining ones have the same part and layer, the one with the lowest rank is selected and marked
/// `surmised`. Otherwise the result is empty. `pictures`: groups of all colours in the file.
[[nodiscard]] std::optional<GroupMatch> match_group(std::span<const GroupCandidate> candidates,
                                                    const ChannelGroup& own,
                                                    std::span<const ChannelGroup> pictures);

}  // namespace postlens
