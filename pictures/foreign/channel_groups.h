// Finds out to which view and layer the channels of another program's OpenEXR file belong. The words in the
// names of channels and parts decide.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pictures/foreign/foreign_file.h"

namespace postlens {

/// Words, in lower case, that name the content of a channel rather than its layer.
using PassWords = std::span<const std::string_view>;

inline constexpr std::string_view colour_words[]{"rgba",  "rgb",    "combined", "beauty",
                                                 "color", "colour", "image"};
inline constexpr std::string_view depth_words[]{"depth", "z", "zdepth", "depthz", "zbuffer", "zbuf"};
inline constexpr std::string_view alpha_words[]{"alpha", "a", "rgba"};
inline constexpr std::string_view id_words[]{"id", "ids", "object", "objectid", "indexob"};
inline constexpr std::string_view vector_words[]{"vector", "vectors", "forward", "motion", "velocity"};

/// View and layer of a channel or of the channels of one pass.
///
/// Programs order names differently: LAYER.depth.Z, depth.LAYER.Z, or a part depth_LAYER with a channel Z. So
/// the words of the part's name and of the channel's name, except the channel's last word, form a set. The
/// words of the set that name neither the pass nor the view are the layer.
struct ChannelGroup {
    std::size_t part = 0;
    std::string view;  ///< from the part or the name, else the first view of `multiView`, else empty
    std::vector<std::string> layer;  ///< words, sorted, lower case; empty: the whole image
    bool has_pass = false;           ///< the names contain a word of the pass
};

/// View and layer of the channels of a part whose names begin with `prefix` (including its dot; empty: no
/// layer).
[[nodiscard]] ChannelGroup channel_group(const ForeignFile& file, std::size_t part, std::string_view prefix,
                                         PassWords pass);

/// Splits a name into words, in lower case, at all characters that are not letters or digits.
[[nodiscard]] std::vector<std::string> words_of(std::string_view name);

/// A channel that may belong to the colours.
struct GroupCandidate {
    ChannelGroup group;
    std::string name;  ///< name for messages
    int rank = 0;      ///< lower is better; decides between equal layers
};

struct GroupMatch {
    std::size_t candidate = 0;
    bool surmised = false;  ///< the names do not prove that it belongs to these colours
};

/// Selects the channel that belongs to the colours of the group `own` (view and layer). The channel must have
/// the same view, and the same layer or one that contains all words of that layer. Among several such
/// channels, the one with the fewest words missing is taken, then one in the part of the colours, then the
/// one with the lowest rank. If there is none, the only candidate of this view (or without a view) is taken
/// and marked `surmised`, unless it belongs to other colours. `pictures` holds the groups of all colours in
/// the file. Otherwise the result is empty: channels of another view or layer are never taken.
[[nodiscard]] std::optional<GroupMatch> match_group(std::span<const GroupCandidate> candidates,
                                                    const ChannelGroup& own,
                                                    std::span<const ChannelGroup> pictures);

}  // namespace postlens
